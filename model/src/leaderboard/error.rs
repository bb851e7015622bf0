//! Errors of a comparison of models.

use crate::baseline::BaselineError;
use crate::directory::DirectoryError;
use crate::evaluation::EvaluateError;
use crate::preparation::setup::SetupError;
use crate::residual::ResidualError;
use datasets::ReadError;
use datasets::metrics::ShapeError;
use feedforward::LoadError;
use std::path::PathBuf;

/// Reason why models could not be compared.
#[derive(Debug, thiserror::Error)]
pub enum LeaderboardError {
    /// Call without any model directory.
    #[error("a leaderboard needs at least one model directory")]
    Nothing,
    /// Models of different robots.
    #[error(
        "{first} is a model of {of_first}, {other} of {of_other}: a leaderboard is about one robot"
    )]
    Robots {
        /// Path of the first model directory.
        first: PathBuf,
        /// Robot and joints of the first directory's model.
        of_first: String,
        /// Path of the directory that differs.
        other: PathBuf,
        /// Robot and joints of the other directory's model.
        of_other: String,
    },
    /// Recording without torque.
    #[error("{0} has no torque to score against")]
    NoTorque(String),
    /// Model directory that cannot be used.
    #[error(transparent)]
    Directory(#[from] DirectoryError),
    /// Options for reading the recording that cannot be made.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// Recording that cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Model that cannot be scored on the recording.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// Model that cannot be loaded into a control loop.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// Compensator that cannot be used.
    #[error(transparent)]
    Residual(#[from] ResidualError),
    /// Linear baseline that cannot be applied.
    #[error(transparent)]
    Baseline(#[from] BaselineError),
    /// Tables of different shapes.
    #[error(transparent)]
    Shape(#[from] ShapeError),
}
