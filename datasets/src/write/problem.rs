//! Problems of writing a file.

/// Problem of writing a file.
#[derive(Debug, thiserror::Error)]
pub enum WriteProblem {
    /// The ending is not that of a format that can be written.
    #[error("cannot be written as `{0}`; use .csv or .parquet")]
    UnknownFormat(String),
    /// The ending is not that of a format for curves.
    #[error("cannot be written as `{0}`; use .mcap or .parquet")]
    NoCurves(String),
    /// Error of the operating system.
    #[error("cannot be written ({0})")]
    Io(#[from] std::io::Error),
    /// Message of the format's encoder.
    #[error("cannot be encoded ({0})")]
    Encoder(String),
}
