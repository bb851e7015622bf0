//! Errors of a stored compensator.

use std::path::PathBuf;

/// Reason why a compensator could not be stored, loaded or used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file could not be read or written.
    #[error("{path}: {source}")]
    Io {
        /// Path of the stored compensator.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A file that is not a complete safetensors file: cut short, or of another format.
    #[error(
        "not a complete safetensors file ({0}); the file is cut short or damaged, train or copy it again"
    )]
    Container(#[from] safetensors::SafeTensorError),
    /// A safetensors file of something else.
    #[error("a safetensors file, but not a compensator: {0}")]
    NotACompensator(String),
    /// Written by another version of the format.
    #[error(
        "compensator format version {found}, this program reads version {supported}; train again or use the matching program"
    )]
    Version {
        /// Version of the format in the file.
        found: u32,
        /// Version that this build reads and writes.
        supported: u32,
    },
    /// The checksum differs from the stored one: the content was changed.
    #[error(
        "checksum of the weights is {found}, the file says {expected}; the file was altered or damaged"
    )]
    Checksum {
        /// Stored SHA-256, hexadecimal.
        expected: String,
        /// Computed SHA-256, hexadecimal.
        found: String,
    },
    /// The header contradicts itself or the tensors.
    #[error("unit {unit}: {problem}")]
    Unit {
        /// Index of the unit in the file.
        unit: usize,
        /// Problem of the unit's header or tensors.
        problem: String,
    },
    /// Trained for another robot.
    #[error("trained for the joints {found:?}, the robot has {expected:?}")]
    Joints {
        /// Names of the joints of the robot at hand.
        expected: Vec<String>,
        /// Names of the joints in the file.
        found: Vec<String>,
    },
    /// Trained on other input columns.
    #[error("trained on the inputs {found:?}, given are {expected:?}")]
    Inputs {
        /// Names of the columns at hand.
        expected: Vec<String>,
        /// Names of the columns in the file.
        found: Vec<String>,
    },
}
