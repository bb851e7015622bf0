//! Part of each mechanism that a model's columns can represent.

use super::plant::Plant;
use identify::least_squares::{Gram, LeastSquaresError, Triangle};
use model::directory::ModelFile;
use model::evaluation::Evaluation;
use model::failure::Failure;
use model::predict::sensitivities;
use model::residual::{input_table, load};
use ndarray::{Array1, Array2, Axis, concatenate};
use serde::Serialize;
use std::path::Path;
use trials::protocols::Effect;

/// One effect on the held-out motion; per joint, N·m RMS.
#[derive(Serialize)]
pub struct Left {
    /// Effect of the simulated robot.
    pub effect: Effect,
    /// Root mean square torque that the effect adds to viscous and Coulomb friction, by joint, N·m.
    pub size: Vec<f64>,
    /// Root mean square residual of the effect beside all columns of the joint's physics, by joint, N·m.
    pub by_physics: Vec<f64>,
    /// Root mean square residual of the effect beside these columns and the inputs of the joint's unit at the same
    /// sample, by joint, N·m; none without a unit.
    pub by_inputs: Vec<Option<f64>>,
}

/// Ridge of the projections, relative to the columns' norms: enough for columns that depend on each other.
const RIDGE: f64 = 1e-6;

/// All effects of the plant that are there.
pub fn left(
    directory: &Path,
    file: &ModelFile,
    plant: &Plant,
    evaluation: &Evaluation,
) -> Result<Vec<Left>, Failure> {
    let session = &evaluation.session;
    let model = file
        .physics
        .model()
        .map_err(model::residual::ResidualError::from)?;
    let physics = sensitivities(&model, session, &file.memory);
    let compensator = load(directory, file)?;
    let inputs = match &file.compensator {
        Some(record) => {
            let torque = session.load(model.load_robot());
            input_table(session, &record.inputs, &torque, &file.memory).swap_remove(0)
        }
        None => Array2::zeros((plant.recording.len(), 0)),
    };
    let mut seen: Vec<Option<&[usize]>> = vec![None; file.joints.len()];
    for unit in compensator.iter().flat_map(|c| &c.units) {
        seen[unit.joint] = Some(&unit.columns);
    }
    let mut all = Vec::new();
    for effect in Effect::ALL {
        let torque = plant.share_of(effect, &session.parts[0])?;
        let size: Vec<f64> = torque
            .columns()
            .into_iter()
            .map(|c| rms(&c.to_owned()))
            .collect();
        if size.iter().all(|s| *s == 0.0) {
            continue;
        }
        let mut found = Left {
            effect,
            size,
            by_physics: Vec::new(),
            by_inputs: Vec::new(),
        };
        for (joint, own) in physics.iter().enumerate() {
            let target = torque.column(joint).to_owned();
            let rest = |columns: &Array2<f64>| {
                unexplained(columns, &target).map_err(|e| Failure::other(e.to_string()))
            };
            found.by_physics.push(rest(&own.columns)?);
            let with_inputs = seen[joint].map(|columns| {
                let inputs = inputs.select(Axis(1), columns).mapv(f64::from);
                rest(&concatenate![Axis(1), own.columns, inputs])
            });
            found.by_inputs.push(with_inputs.transpose()?);
        }
        all.push(found);
    }
    Ok(all)
}

/// Root mean square residual of `target` beside `columns` and a constant.
fn unexplained(columns: &Array2<f64>, target: &Array1<f64>) -> Result<f64, LeastSquaresError> {
    let constant = Array2::ones((columns.nrows(), 1));
    let columns = concatenate![Axis(1), *columns, constant];
    let gram = Gram::from(&Triangle::of(columns.view(), target.view())?);
    let all: Vec<usize> = (0..columns.ncols())
        .filter(|&c| columns.column(c).iter().any(|v| *v != 0.0))
        .collect();
    let rest = match gram.fit(&all, RIDGE)? {
        Some(fit) => gram.residual_sum_of_squares(&all, &fit.parameters)?,
        None => target.dot(target),
    };
    Ok((rest.max(0.0) / target.len() as f64).sqrt())
}

fn rms(values: &Array1<f64>) -> f64 {
    (values.dot(values) / values.len() as f64).sqrt()
}
