//! Errors of training.

use std::path::PathBuf;

/// Reason why a unit could not be trained.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Tables of samples that do not fit together, with the reason.
    #[error("training data: {0}")]
    Samples(String),
    /// Value of the training data that is not finite.
    #[error(
        "training data: {table} is not finite in row {row}, column {column}; remove or repair that sample"
    )]
    NotFinite {
        /// Name of the table: `input`, `target` or `weight`.
        table: &'static str,
        /// Row of the value, from 0.
        row: usize,
        /// Column of the value, from 0.
        column: usize,
    },
    /// Too few trajectories, or only trajectories without weight, with the reason.
    #[error("{0}")]
    TooLittleData(String),
    /// Setting out of its range.
    #[error("setting `{setting}`: {problem}")]
    Config {
        /// Name of the setting's field.
        setting: &'static str,
        /// Problem with the setting's value.
        problem: String,
    },
    /// Training in which a quantity is no longer finite; no step was taken with it.
    #[error(
        "training diverged in epoch {epoch}: the {what} is not finite; lower the learning rate"
    )]
    Diverged {
        /// Epoch in which the training diverged, from 1.
        epoch: usize,
        /// Name of the quantity: `loss`, `gradient` or `validation error`.
        what: &'static str,
    },
    /// Training that was cancelled. A checkpoint was written where one was asked for.
    #[error("interrupted")]
    Interrupted,
    /// Checkpoint of other data, settings or seed.
    #[error("{path}: the checkpoint belongs to other {what}; start afresh without it")]
    OtherCheckpoint {
        /// Path of the other checkpoint.
        path: PathBuf,
        /// Difference in words: `settings`, or `data or another seed`.
        what: &'static str,
    },
    /// Checkpoint in the format of another version.
    #[error(
        "{path}: checkpoint of format {found}, this program reads {supported}; start afresh without it, or go on with the program that wrote it"
    )]
    CheckpointVersion {
        /// Path of the checkpoint.
        path: PathBuf,
        /// Format that the checkpoint has.
        found: u32,
        /// Format that this build reads and writes.
        supported: u32,
    },
    /// Checkpoint that cannot be read.
    #[error("{path}: unusable checkpoint ({problem}); start afresh without it")]
    BadCheckpoint {
        /// Path of the checkpoint.
        path: PathBuf,
        /// Problem with its content.
        problem: String,
    },
    /// File that cannot be read or written.
    #[error("{path}: {source}")]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// Trained unit that the run-time refuses, with the reason.
    #[error("trained unit: {0}")]
    Unit(String),
    /// Ridge regression whose normal equations cannot be solved.
    #[error("ridge regression: the normal equations could not be solved")]
    Singular,
    /// Boosted trees that cannot be grown or used.
    #[error("boosted trees: {0}")]
    Trees(String),
    /// Build without the feature `networks`, which cannot train networks.
    #[error("this program was built without the training of networks")]
    Networks,
    /// Missing GPU, or a build without GPU support.
    #[error("{0}")]
    Gpu(String),
}
