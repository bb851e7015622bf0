//! Errors of making or joining sums.

use super::preparation::Preparation;
use crate::identify::error::IdentifyError;
use crate::physics_fit::FitError;
use ::identify::least_squares::LeastSquaresError;

/// Reason why sums cannot be made or joined.
#[derive(Debug, thiserror::Error)]
pub enum SumsError {
    /// Recording that cannot be used, or recordings that determine nothing.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// Sums that belong to two robots.
    #[error("these are sums of another robot: name, frames, inertials or gravity differ")]
    OtherRobot,
    /// Sums whose recordings were prepared differently.
    #[error("one was prepared with {own}, the other with {others}")]
    OtherPreparation {
        /// Preparation of the sums that were to be added to.
        own: Preparation,
        /// Preparation of the other sums.
        others: Preparation,
    },
    /// Bytes that do not hold sums, with the reason.
    #[error("no stored sums: {0}")]
    Broken(String),
}

impl From<IdentifyError> for SumsError {
    fn from(error: IdentifyError) -> Self {
        Self::Fit(error.into())
    }
}

impl From<LeastSquaresError> for SumsError {
    fn from(error: LeastSquaresError) -> Self {
        IdentifyError::from(error).into()
    }
}
