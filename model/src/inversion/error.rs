//! Errors of computing positions from torque.

use crate::directory::DirectoryError;
use crate::residual::ResidualError;
use datasets::prepare::PrepareError;
use physics::torque_model::TorqueModelError;

/// Reason why positions cannot be computed from torque.
#[derive(Debug, thiserror::Error)]
pub enum InversionError {
    /// No trajectory from which to learn motions.
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
    /// A joint that does not move.
    #[error("a joint never moves: where it stands cannot be learned from torque")]
    Still,
    /// A recording without torque.
    #[error("`{0}` has no torque")]
    NoTorque(String),
    /// A recording of another rate, or with longer trajectories.
    #[error("`{0}` has another rate than the motions that were learned, or longer trajectories")]
    Other(String),
    /// Cancelled before the end.
    #[error("interrupted")]
    Interrupted,
    /// The decomposition did not converge.
    #[error("the decomposition of the motions did not converge")]
    Decomposition,
    /// A model that does not fit together.
    #[error(transparent)]
    Model(#[from] TorqueModelError),
    /// Files of the model directory.
    #[error(transparent)]
    Directory(#[from] DirectoryError),
    /// The motion found cannot be prepared.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// The compensator cannot be used.
    #[error(transparent)]
    Residual(#[from] ResidualError),
}
