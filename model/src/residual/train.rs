//! Training of the units on the physics' residual.

use super::examples::Examples;
use super::inputs::{Preset, input_table, inputs, remember};
use super::task::{ResidualOptions, Task, within};
use super::trial::Trial;
use super::yardsticks::{self, Splits, Yardsticks};
use super::{Pace, ResidualError, predict_from};
use crate::directory::sha256;
use crate::physics_fit::Fit;
use crate::spread::LeftOut;
use compensator::training::{Control, Split, train};
use datasets::Recording;
use feedforward::clock::Memory;
use feedforward::inputs::{CompensatorRecord, UnitValidation};
use feedforward::network::Compensator;
use ndarray::Array2;
use physics::robot::Builtin;

/// Trained compensator with its record for `model.json`.
pub struct Learned {
    /// Compensator of all units.
    pub compensator: Compensator,
    /// Contents of `compensator.safetensors`.
    pub bytes: Vec<u8>,
    /// Record of the training, for `model.json`.
    pub record: CompensatorRecord,
    /// Memory of the model's terms and of the units' inputs.
    pub memory: Vec<Memory>,
    /// Residual torque of every recording of the session, shape (samples, joints).
    pub torque: Vec<Array2<f64>>,
    /// Errors of physics and unit of each joint on folds on which neither was fitted; none without folds.
    pub left: Vec<LeftOut>,
    /// Yardsticks on the same inputs, where they were asked for.
    pub yardsticks: Option<Compared>,
}

/// Yardsticks beside the units.
pub struct Compared {
    /// Yardsticks fitted on the same inputs.
    pub yardsticks: Yardsticks,
    /// Residual torque that the yardsticks predict for every recording of the session, by ridge and trees
    /// (where there are some), shape (samples, joints).
    pub torque: Vec<Vec<Array2<f64>>>,
}

/// Trains one unit per joint on the physics' residual of the first `data.len()` recordings of the session.
///
/// Whether a unit helps is judged by a first training of one network with folds held back: it is switched off
/// where it does not lower the error there. The units that stay on are then trained on all data, for a fixed
/// number of epochs. `apart` is the torque of [`physics_out_of_fold`](crate::cross_fit::physics_out_of_fold),
/// for errors on samples left out.
///
/// # Errors
/// Too little data, values that are not finite, an interruption (checkpoints stay).
pub fn train_residual(
    fit: &Fit,
    data: &[Recording],
    apart: &[Array2<f64>],
    options: &ResidualOptions,
    control: &Control,
) -> Result<Learned, ResidualError> {
    let joints = fit.file.joints.len();
    let model = fit.file.physics.model()?;
    // Windows keep their length in time: faster recordings are taken apart into several sequences.
    let period = 1.0 / fit.file.preprocessing.rate_hz;
    let examples = Examples::new(fit, data, period, options.moving_only);
    let companions = match options.preset {
        Preset::Default => examples.companions(fit)?,
        Preset::Ucm => vec![Vec::new(); joints],
    };
    let (list, seen) = inputs(
        options.preset,
        joints,
        options.moving_only,
        fit.file.physics.builtin.and_then(Builtin::nested_gears),
        &examples.waves(fit),
        &companions,
    );
    let load = fit.session.load(model.load_robot());
    let tables = input_table(&fit.session, &list, &load, &[]);
    let stacked = examples.of(&tables);
    let task = Task {
        inputs: &stacked,
        examples: &examples,
        seen: &seen,
        options,
    };
    let splits = options.yardsticks.then(|| Splits::new(&examples.folds));
    let splits = splits.transpose()?;
    let judged = Trial::run(&task, fit, data, apart, control)?;
    let everything = Split {
        train: (0..examples.segments.len()).collect(),
        validation: Vec::new(),
    };
    let finals = task.jobs(&examples.targets, &everything)?;
    let mut units = Vec::new();
    let trained = train(&finals, &within(control, "final").view(control))?;
    let mut validation = Vec::new();
    for (k, mut trained) in trained.into_iter().enumerate() {
        let trial = judged.units.get(k);
        if let Some((network, _)) = trial {
            trained.unit.enabled = network.unit.enabled;
        }
        validation.push(UnitValidation {
            joint: fit.file.joints[trained.unit.joint].clone(),
            enabled: trained.unit.enabled,
            physics: trial.and_then(|(n, _)| n.report.validation_rmse_off),
            with_unit: trial.and_then(|(n, _)| n.report.validation_rmse),
            with_ridge: trial.and_then(|(_, r)| r.report.validation_rmse),
            companions: companions[trained.unit.joint].clone(),
        });
        units.push(trained.unit);
    }
    let compensator = Compensator {
        joints: fit.file.joints.clone(),
        inputs: list.iter().map(|i| i.name()).collect(),
        units,
    };
    let bytes = compensator.to_bytes()?;
    let parts = || tables.iter().zip(&fit.session.parts);
    let torque = parts()
        .map(
            |(table, part)| match Pace::new(part.report.rate_hz, period) {
                Some(pace) => predict_from(&compensator, table, &part.at_samples.segments, pace),
                None => Ok(Array2::zeros(part.at_samples.q.dim())),
            },
        )
        .collect::<Result<_, _>>()?;
    let compared = |splits: &Splits| {
        let names = (&compensator.joints[..], compensator.inputs.clone());
        let found = yardsticks::train(&task, splits, &judged, names, control.cancel)?;
        let torque = parts().map(
            |(table, part)| match Pace::new(part.report.rate_hz, period) {
                Some(pace) => found.torques(table, &part.at_samples.segments, pace),
                None => Ok(found.none(part.at_samples.q.dim())),
            },
        );
        Ok::<_, ResidualError>(Compared {
            torque: torque.collect::<Result<_, _>>()?,
            yardsticks: found,
        })
    };
    let yardsticks = splits.as_ref().map(compared).transpose()?;
    let record = CompensatorRecord {
        inputs: list,
        period,
        sha256: sha256(&bytes),
        validation,
    };
    let mut memory = fit.file.memory.clone();
    remember(&mut memory, &fit.session, &record.inputs, &load, data.len());
    Ok(Learned {
        memory,
        compensator,
        bytes,
        record,
        torque,
        left: judged.left,
        yardsticks,
    })
}
