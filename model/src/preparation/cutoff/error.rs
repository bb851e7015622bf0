//! Why no cut-off could be chosen.

use crate::identify::error::IdentifyError;
use datasets::prepare::PrepareError;

/// Why no cut-off could be chosen.
#[derive(Debug, thiserror::Error)]
pub enum CutoffError {
    /// A recording cannot be prepared.
    #[error("{file}: {source}")]
    Prepare {
        /// The recording.
        file: String,
        /// Why.
        source: PrepareError,
    },
    /// The basic model cannot be fitted.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
}
