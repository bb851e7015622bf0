//! Why the learned part could not be trained, loaded or evaluated.

use crate::directory::DirectoryError;
use feedforward::LoadError;

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
    /// The yardsticks' files.
    #[error(transparent)]
    Directory(#[from] DirectoryError),
    /// Yardsticks need trajectories to fit, to choose by and to judge by.
    #[error(
        "yardsticks need training trajectories in at least three folds: to fit, to choose by, to judge by"
    )]
    Folds,
}
