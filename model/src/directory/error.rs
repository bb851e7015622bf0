//! Errors of reading or writing a model directory.

use feedforward::model_file::ModelFileError;
use physics::torque_model::TorqueModelError;
use std::path::PathBuf;

/// Reason why a model directory cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum DirectoryError {
    /// File of the directory that cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// Path of the file that cannot be read.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// File that is not a model file.
    #[error("{path}: not a model of this program: {reason}")]
    Format {
        /// Path of the file that is not a model.
        path: PathBuf,
        /// Reason why it is not a model.
        reason: String,
    },
    /// Directory that `machine identify` wrote.
    #[error(
        "{path}: a machine of the motion controller's kinds, not a serial arm; machine eval and machine payload read it"
    )]
    Machine {
        /// Path of the model's file.
        path: PathBuf,
    },
    /// File beside the model that another version wrote.
    #[error("{path}: schema {found:?}, this program reads {read:?}; train the model again")]
    Schema {
        /// Path of the file with another schema.
        path: PathBuf,
        /// Schema that the file names.
        found: String,
        /// Schema that this program reads.
        read: &'static str,
    },
    /// File that was made with another model than the one beside it.
    #[error("{path}: made with another model than the model.json beside it (checksum differs)")]
    Other {
        /// Path of the file that was made with another model.
        path: PathBuf,
    },
    /// `model.json` is not of this version.
    #[error("{path}: {source}")]
    Model {
        /// Path of the model file.
        path: PathBuf,
        /// Reason why its version is not read.
        source: ModelFileError,
    },
    /// Parts of the model that do not fit together.
    #[error("{path}: {source}")]
    Physics {
        /// Path of the model file.
        path: PathBuf,
        /// Reason why its parts do not fit together.
        source: TorqueModelError,
    },
    /// Directory that cannot be created, or whose old files cannot be removed.
    #[error("{path}: {source}")]
    Folder {
        /// Path of the directory that cannot be created or cleared.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// File that cannot be written.
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
