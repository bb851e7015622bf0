//! Errors of an evaluation.

use crate::baseline::BaselineError;
use crate::directory::DirectoryError;
use crate::inversion::InversionError;
use crate::preparation::units::Degrees;
use crate::residual::ResidualError;
use datasets::metrics::ShapeError;
use datasets::prepare::PrepareError;
use physics::torque_model::TorqueModelError;

/// Reason why an evaluation failed.
#[derive(Debug, thiserror::Error)]
pub enum EvaluateError {
    /// Model directory that cannot be used.
    #[error(transparent)]
    Directory(#[from] DirectoryError),
    /// Recording that cannot be prepared.
    #[error("{file}: {source}")]
    Prepare {
        /// Name of the recording that cannot be prepared.
        file: String,
        /// Reason why it cannot be prepared.
        source: PrepareError,
    },
    /// Stored model that does not fit together.
    #[error(transparent)]
    Model(#[from] TorqueModelError),
    /// Compensator that cannot be used.
    #[error(transparent)]
    Residual(#[from] ResidualError),
    /// Positions from torque cannot be computed.
    #[error(transparent)]
    Inversion(#[from] InversionError),
    /// Linear baseline that cannot be applied.
    #[error(transparent)]
    Baseline(#[from] BaselineError),
    /// Tables of different shapes.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// Recording in another unit.
    #[error(transparent)]
    Degrees(#[from] Degrees),
    /// Model of another robot.
    #[error(
        "{file} has {found} joints, the model {expected}; give a recording of the model's robot ({robot})"
    )]
    Joints {
        /// Name of the recording with another number of joints.
        file: String,
        /// Number of joints of the recording.
        found: usize,
        /// Number of joints of the model.
        expected: usize,
        /// Name of the model's robot.
        robot: String,
    },
}
