//! Why sums cannot be made or joined.

use super::preparation::Preparation;
use crate::identify::error::IdentifyError;
use crate::physics_fit::FitError;
use ::identify::least_squares::LeastSquaresError;

/// What is wrong.
#[derive(Debug, thiserror::Error)]
pub enum SumsError {
    /// A recording cannot be used, or all of them tell nothing.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// Sums of two robots.
    #[error("these are sums of another robot: name, frames, inertials or gravity differ")]
    OtherRobot,
    /// Recordings that were not prepared alike.
    #[error("one was prepared with {own}, the other with {others}")]
    OtherPreparation {
        /// Of the one.
        own: Preparation,
        /// Of the other.
        others: Preparation,
    },
    /// Bytes that are no sums.
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
