//! The estimators of `::identify`, applied to recordings.
//!
//! Ordinary and weighted least squares need the normal equations alone, whatever the number of samples;
//! reweighted and iterative ones keep the rows in memory.

mod options;
mod passes;
mod possible;
mod prior;
mod rows;
mod solution;

pub use options::{Estimator, EstimatorOptions, Lmi};
pub(crate) use passes::solve_systems;
pub use possible::constrained;
pub use prior::Known;
pub(crate) use solution::offsets;
pub use solution::{EstimatorReport, Solution};

use crate::identify::design::Data;
use crate::identify::error::IdentifyError;
use ndarray::Array2;
use physics::effects::Term;

/// Estimates base parameters and `terms`. `load` is the torque for load-dependent terms, N·m (N), shape
/// (samples, joints) per recording.
///
/// # Errors
/// Nothing to fit, or a system that cannot be solved.
pub fn solve(
    data: &Data,
    terms: Vec<Vec<Term>>,
    load: &[Array2<f64>],
    options: &EstimatorOptions,
) -> Result<Solution, IdentifyError> {
    match options.estimator {
        Estimator::Ols | Estimator::Wls => passes::solve(data, terms, load, options),
        Estimator::Irls | Estimator::Iterative => rows::solve(data, terms, load, options),
    }
}
