//! Errors of the choice of a cut-off.

use crate::identify::error::IdentifyError;
use datasets::prepare::PrepareError;

/// Reason why no cut-off could be chosen.
#[derive(Debug, thiserror::Error)]
pub enum CutoffError {
    /// Recording that cannot be prepared.
    #[error("{file}: {source}")]
    Prepare {
        /// Name of the recording that cannot be prepared.
        file: String,
        /// Reason why it cannot be prepared.
        source: PrepareError,
    },
    /// Basic model that cannot be fitted.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
}
