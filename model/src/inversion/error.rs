//! Errors of computing positions from torque.

use crate::directory::DirectoryError;
use crate::residual::ResidualError;
use datasets::prepare::PrepareError;
use physics::torque_model::TorqueModelError;

/// Reason why positions cannot be computed from torque.
#[derive(Debug, thiserror::Error)]
pub enum InversionError {
    /// Recordings without any trajectory from which motions can be learned.
    #[error("there is no trajectory of six samples or more to learn motions from")]
    NoTrajectory,
    /// Too few trajectories of one length for that many shapes.
    #[error(
        "{trajectories} trajectories of one length are made of {shapes} shapes: that takes {needed} of them at least"
    )]
    TooFew {
        /// Number of trajectories of the most common length.
        trajectories: usize,
        /// Number of shapes that they need.
        shapes: usize,
        /// Number of trajectories needed.
        needed: usize,
    },
    /// Joint that does not move.
    #[error("a joint never moves: where it stands cannot be learned from torque")]
    Still,
    /// Recording without torque, with its name.
    #[error("`{0}` has no torque")]
    NoTorque(String),
    /// Recording of another rate or with longer trajectories, with its name.
    #[error("`{0}` has another rate than the motions that were learned, or longer trajectories")]
    Other(String),
    /// Search that was cancelled.
    #[error("interrupted")]
    Interrupted,
    /// Matrix decomposition that did not converge.
    #[error("the decomposition of the motions did not converge")]
    Decomposition,
    /// Model whose parts do not fit together.
    #[error(transparent)]
    Model(#[from] TorqueModelError),
    /// File of the model directory that cannot be read or written.
    #[error(transparent)]
    Directory(#[from] DirectoryError),
    /// Motion that was found but cannot be prepared.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// Compensator that cannot be used.
    #[error(transparent)]
    Residual(#[from] ResidualError),
}
