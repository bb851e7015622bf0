//! Errors of reading or writing a model directory.

use feedforward::model_file::ModelFileError;
use physics::torque_model::TorqueModelError;
use std::path::PathBuf;

/// Reason why a model directory cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum DirectoryError {
    /// A file cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// A file is no model.
    #[error("{path}: not a model of this program: {reason}")]
    Format {
        /// Path of the file.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
    /// The directory was written by `machine identify`.
    #[error(
        "{path}: a machine of the motion controller's kinds, not a serial arm; machine eval and machine payload read it"
    )]
    Machine {
        /// Path of its file.
        path: PathBuf,
    },
    /// A file beside the model was written by another version.
    #[error("{path}: schema {found:?}, this program reads {read:?}; train the model again")]
    Schema {
        /// Path of the file.
        path: PathBuf,
        /// Schema of the file.
        found: String,
        /// Schema that this program reads.
        read: &'static str,
    },
    /// A file was made with another model than the one beside it.
    #[error("{path}: made with another model than the model.json beside it (checksum differs)")]
    Other {
        /// Path of the file.
        path: PathBuf,
    },
    /// `model.json` is not of this version.
    #[error("{path}: {source}")]
    Model {
        /// Path of the file.
        path: PathBuf,
        /// Cause.
        source: ModelFileError,
    },
    /// The parts of the model do not fit together.
    #[error("{path}: {source}")]
    Physics {
        /// Path of the file.
        path: PathBuf,
        /// Cause.
        source: TorqueModelError,
    },
    /// The directory cannot be created, or an old file in it cannot be removed.
    #[error("{path}: {source}")]
    Folder {
        /// Path of the directory.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] report::WriteError),
}

impl DirectoryError {
    pub(super) fn sizes(path: PathBuf) -> Self {
        Self::Format {
            path,
            reason: "its parts have different sizes".into(),
        }
    }
}
