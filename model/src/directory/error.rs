//! A model directory that cannot be read or written.

use feedforward::model_file::ModelFileError;
use physics::torque_model::TorqueModelError;
use std::path::PathBuf;

/// A model directory that cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum DirectoryError {
    /// A file cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file is no model.
    #[error("{path}: not a model of this program: {reason}")]
    Format {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The directory is of `machine identify`.
    #[error(
        "{path}: a machine of the motion controller's kinds, not a serial arm; machine eval and machine payload read it"
    )]
    Machine {
        /// Its file.
        path: PathBuf,
    },
    /// A file beside it was written by another version.
    #[error("{path}: schema {found:?}, this program reads {read:?}; train the model again")]
    Schema {
        /// The file.
        path: PathBuf,
        /// Its schema.
        found: String,
        /// The schema of this program.
        read: &'static str,
    },
    /// Made with another model than the one that it stands beside.
    #[error("{path}: made with another model than the model.json beside it (checksum differs)")]
    Other {
        /// The file.
        path: PathBuf,
    },
    /// `model.json` is none of this version.
    #[error("{path}: {source}")]
    Model {
        /// The file.
        path: PathBuf,
        /// Why.
        source: ModelFileError,
    },
    /// The parts of the model do not fit together.
    #[error("{path}: {source}")]
    Physics {
        /// The file.
        path: PathBuf,
        /// Why.
        source: TorqueModelError,
    },
    /// The directory cannot be made, or an old file in it not be removed.
    #[error("{path}: {source}")]
    Folder {
        /// The directory.
        path: PathBuf,
        /// Why.
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
