//! A model directory that cannot be used.

use crate::network::Error as NetworkError;
use physics::torque_model::TorqueModelError;
use std::path::PathBuf;

/// A model directory that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// File of the directory that cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// Path of the file that cannot be read.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// `model.json` is not one of this version.
    #[error("{path}: {reason}")]
    Format {
        /// Path of the model file.
        path: PathBuf,
        /// Reason why it is not of this version.
        reason: String,
    },
    /// The physical model does not fit together.
    #[error(transparent)]
    Physics(#[from] TorqueModelError),
    /// The compensator cannot be used.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// Control period that is not positive and finite, s.
    #[error("a control period of {0} s is not positive")]
    Period(f64),
    /// The control period is too short or too long for the compensator's windows.
    #[error(
        "the compensator was trained on samples {trained:.4} s apart: a control period of {period} s is outside {shortest:.6} to \
         {longest:.4} s"
    )]
    Windows {
        /// Control period that was asked for, s.
        period: f64,
        /// The period of training, s.
        trained: f64,
        /// Shortest period that the compensator can run at, s.
        shortest: f64,
        /// Longest period that the compensator can run at, s.
        longest: f64,
    },
}
