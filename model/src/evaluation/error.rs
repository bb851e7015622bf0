//! Why a recording could not be scored.

use crate::baseline::BaselineError;
use crate::directory::DirectoryError;
use crate::inversion::InversionError;
use crate::preparation::units::Degrees;
use crate::residual::ResidualError;
use datasets::metrics::ShapeError;
use datasets::prepare::PrepareError;
use physics::torque_model::TorqueModelError;

/// Why an evaluation failed.
#[derive(Debug, thiserror::Error)]
pub enum EvaluateError {
    /// The model directory.
    #[error(transparent)]
    Directory(#[from] DirectoryError),
    /// The recording cannot be prepared.
    #[error("{file}: {source}")]
    Prepare {
        /// The recording.
        file: String,
        /// Why.
        source: PrepareError,
    },
    /// The stored model.
    #[error(transparent)]
    Model(#[from] TorqueModelError),
    /// The compensator.
    #[error(transparent)]
    Residual(#[from] ResidualError),
    /// Positions from torque.
    #[error(transparent)]
    Inversion(#[from] InversionError),
    /// The linear baseline.
    #[error(transparent)]
    Baseline(#[from] BaselineError),
    /// Tables of different shapes.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The recording is in another unit.
    #[error(transparent)]
    Degrees(#[from] Degrees),
    /// The model is for another robot.
    #[error(
        "{file} has {found} joints, the model {expected}; give a recording of the model's robot ({robot})"
    )]
    Joints {
        /// The recording.
        file: String,
        /// Its joints.
        found: usize,
        /// Joints of the model.
        expected: usize,
        /// Name of the robot.
        robot: String,
    },
}
