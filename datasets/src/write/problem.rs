//! What can go wrong while writing.

/// What went wrong while writing.
#[derive(Debug, thiserror::Error)]
pub enum WriteProblem {
    /// The ending is not that of a format that can be written.
    #[error("cannot be written as `{0}`; use .csv or .parquet")]
    UnknownFormat(String),
    /// The disk.
    #[error("cannot be written ({0})")]
    Io(#[from] std::io::Error),
    /// The encoder.
    #[error("cannot be encoded ({0})")]
    Encoder(String),
}
