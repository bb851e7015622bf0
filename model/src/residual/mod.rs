//! The learned part of a model: inputs, training on the residual torque, prediction.

mod examples;
mod inputs;
mod members;
pub mod onnx;
mod pace;
mod task;
mod train;
mod trial;
pub mod waves;

pub use inputs::{Preset, input_table, inputs, remember};
pub use members::member_torques;
pub use pace::Pace;
pub use task::ResidualOptions;
pub use train::{Learned, train_residual};

use crate::directory::ModelFile;
use crate::session::Session;
use compensator::training::{Samples, predict as predict_unit};
use feedforward::LoadError;
use feedforward::network::Compensator;
use ndarray::{Array1, Array2, Axis};
use physics::torque_model::TorqueModel;
use std::path::Path;

/// Why the learned part could not be trained, loaded or evaluated.
#[derive(Debug, thiserror::Error)]
pub enum ResidualError {
    /// Training or evaluation.
    #[error(transparent)]
    Compensator(#[from] compensator::Error),
    /// The stored network.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The network's file.
    #[error(transparent)]
    Network(#[from] feedforward::network::Error),
    /// The physical model.
    #[error(transparent)]
    Model(#[from] physics::torque_model::TorqueModelError),
}

/// Loads the compensator of a model directory, where there is one.
///
/// # Errors
/// A missing, damaged or altered file, or one of another robot.
pub fn load(directory: &Path, file: &ModelFile) -> Result<Option<Compensator>, ResidualError> {
    let Some(record) = &file.compensator else {
        return Ok(None);
    };
    Ok(Some(feedforward::load_network(
        directory,
        record,
        &file.joints,
    )?))
}

/// Residual torque at the samples of one recording of the session, shape (samples, joints).
///
/// # Errors
/// A compensator that does not fit its record.
pub fn predict(
    compensator: &Compensator,
    file: &ModelFile,
    model: &TorqueModel,
    session: &Session,
    part: usize,
) -> Result<Array2<f64>, ResidualError> {
    let Some(record) = &file.compensator else {
        return Ok(Array2::zeros(session.parts[part].at_samples.q.dim()));
    };
    let part_motion = &session.parts[part];
    let Some(pace) = Pace::new(part_motion.report.rate_hz, record.period) else {
        return Ok(Array2::zeros(part_motion.at_samples.q.dim()));
    };
    let tables = input_table(
        session,
        &record.inputs,
        &session.load(model.load_robot()),
        &file.memory,
    );
    predict_from(
        compensator,
        &tables[part],
        &part_motion.at_samples.segments,
        pace,
    )
}

/// Residual torque from a table of inputs, shape (samples, joints); each segment starts from a reset.
///
/// # Errors
/// A unit that contradicts itself, or inputs that are not finite.
pub fn predict_from(
    compensator: &Compensator,
    table: &Array2<f32>,
    segments: &[std::ops::Range<usize>],
    pace: Pace,
) -> Result<Array2<f64>, ResidualError> {
    let (rows, phases) = pace.rows(segments);
    let paced = table.select(Axis(0), &rows);
    let mut torque = Array2::zeros((table.nrows(), compensator.joints.len()));
    let nothing = Array1::<f32>::zeros(rows.len());
    let samples = Samples::new(paced.view(), nothing.view(), None, &phases)?;
    let all: Vec<usize> = (0..phases.len()).collect();
    for unit in &compensator.units {
        let residual = predict_unit(unit, &samples, &all)?;
        for (&row, value) in rows.iter().zip(residual) {
            torque[[row, unit.joint]] += f64::from(value);
        }
    }
    Ok(torque)
}
