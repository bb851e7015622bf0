//! Exciting trajectories: motions within the robot's limits from which parameters can be told well.
//!
//! Periodic Fourier series (Swevers et al., IEEE Trans. Robotics and Automation 13(5), 1997; Han et al., IEEE T-RO
//! 36(5), 2020, eqs 33 and 34), improved by coordinate search from several random starts. Deterministic: the same
//! seed gives the same trajectory.

mod criterion;
mod fourier;
mod rows;
mod search;
#[cfg(test)]
mod tests;

pub use criterion::{Criterion, Excitation};
pub use fourier::{Fourier, MotionLimits};
pub use rows::BaseRows;
pub use search::{Found, SearchOptions, optimise};

use crate::least_squares::LeastSquaresError;

/// Why no exciting trajectory could be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExcitationError {
    /// Limits that leave no motion, or are not finite.
    #[error(
        "joint {joint} has no room to move: range, velocity and acceleration limits must be positive and finite"
    )]
    NoRoom {
        /// The joint, from zero.
        joint: usize,
    },
    /// No joints, no harmonics, no time or no samples.
    #[error("nothing to optimise: {0} must be positive")]
    Empty(&'static str),
    /// The regressor could not be judged.
    #[error(transparent)]
    LeastSquares(#[from] LeastSquaresError),
}
