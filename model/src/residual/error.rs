//! Errors of training, loading and evaluating the learned part.

use crate::directory::DirectoryError;
use ::identify::least_squares::LeastSquaresError;
use feedforward::LoadError;

/// Reason why the learned part could not be trained, loaded or evaluated.
#[derive(Debug, thiserror::Error)]
pub enum ResidualError {
    /// Training or evaluation failed.
    #[error(transparent)]
    Compensator(#[from] compensator::Error),
    /// Stored network that cannot be loaded.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// Network's file that cannot be used.
    #[error(transparent)]
    Network(#[from] feedforward::network::Error),
    /// Physical model that does not fit together.
    #[error(transparent)]
    Model(#[from] physics::torque_model::TorqueModelError),
    /// Yardsticks' files that cannot be used.
    #[error(transparent)]
    Directory(#[from] DirectoryError),
    /// Residual that is not finite where other joints' motion is tried beside it.
    #[error(transparent)]
    LeastSquares(#[from] LeastSquaresError),
    /// Training trajectories in fewer than three folds: yardsticks need one to fit, one to choose and one to judge.
    #[error(
        "yardsticks need training trajectories in at least three folds: to fit, to choose by, to judge by"
    )]
    Folds,
}
