//! The learned part of a model: inputs, training on the residual torque, prediction.

mod companions;
mod error;
mod examples;
mod inputs;
mod members;
pub mod onnx;
mod pace;
mod predicted;
mod task;
mod train;
mod trial;
pub mod waves;
mod yardsticks;

pub use error::ResidualError;
pub use inputs::{Preset, input_table, inputs, remember};
pub use members::member_torques;
pub use pace::Pace;
pub use task::ResidualOptions;
pub use train::{Compared, Learned, train_residual};
pub use yardsticks::{HeldBack, Yardsticks};

use crate::directory::ModelFile;
use crate::session::Session;
use feedforward::network::Compensator;
use ndarray::Array2;
use physics::torque_model::TorqueModel;
use predicted::summed;
use std::path::Path;

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
    let motion = &session.parts[part].at_samples;
    match paced_table(file, model, session, part) {
        Some((table, pace)) => predict_from(compensator, &table, &motion.segments, pace),
        None => Ok(Array2::zeros(motion.q.dim())),
    }
}

/// Inputs of a stored model's compensator on one recording of the session, and its pace there. None without a
/// compensator, or where the recording is too slow for it.
fn paced_table(
    file: &ModelFile,
    model: &TorqueModel,
    session: &Session,
    part: usize,
) -> Option<(Array2<f32>, Pace)> {
    let record = file.compensator.as_ref()?;
    let pace = Pace::new(session.parts[part].report.rate_hz, record.period)?;
    let load = session.load(model.load_robot());
    let mut tables = input_table(session, &record.inputs, &load, &file.memory);
    Some((tables.swap_remove(part), pace))
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
    let joints = compensator.joints.len();
    summed(&compensator.units, joints, table, segments, pace)
}
