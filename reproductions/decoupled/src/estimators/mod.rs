//! The estimators, behind one trait and listed once.

mod instruments;
mod least_squares;
mod likelihood;
mod projection;

pub use instruments::Instruments;
pub use least_squares::LeastSquares;
pub use likelihood::MaximumLikelihood;
pub use projection::Projection;

use crate::DecoupledError;
use crate::joint::Columns;
use crate::moments::{Moments, Noise, Rows, Solved};
use crate::run::Run;
use faer::{Mat, MatRef};
use serde::Serialize;

/// Parameters of a joint, as one estimator finds them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Values in the order of the columns.
    pub parameters: Vec<f64>,
    /// Standard deviations.
    pub std: Vec<f64>,
    /// Noise that they were taken from; none where the estimator knows no such thing.
    pub noise: Option<Noise>,
    /// Correlation of the projected torque with what is left of it; the projection's alone.
    pub correlation: Option<f64>,
}

/// An estimator of a joint's parameters from one run in closed loop.
pub trait Estimator: Sync {
    /// Name on the command line.
    fn name(&self) -> &'static str;

    /// What it does, in a few words.
    fn words(&self) -> &'static str;

    /// The parameters; `known` is torque of each sample that is already explained.
    ///
    /// # Errors
    /// A motion that does not tell them.
    fn estimate(
        &self,
        run: &Run,
        columns: Columns,
        known: &dyn Fn(usize) -> f64,
    ) -> Result<Estimate, DecoupledError>;
}

/// All of them, in the order of tables.
pub const ALL: [&dyn Estimator; 4] = [&LeastSquares, &Projection, &Instruments, &MaximumLikelihood];

/// Lags at which the reference is taken over its period: more than the eleven functions that five harmonics and a constant are,
/// so that the filter is free within them.
const TAPS: usize = 12;
/// Ridge of the filter's normal equations relative to their mean diagonal: a reference of few harmonics leaves them without
/// rank.
const RIDGE: f64 = 1e-11;

/// The estimate of solved moments.
fn estimate(solved: &Solved, noise: Noise) -> Estimate {
    let diagonal = (0..solved.parameters.len()).map(|j| solved.covariance[(j, j)]);
    Estimate {
        parameters: solved.parameters.clone(),
        std: diagonal.map(|v| v.max(0.0).sqrt()).collect(),
        noise: Some(noise),
        correlation: None,
    }
}

/// Solves moments for the parameters, and with the noise that these leave; beside the estimate the covariance of the moments by
/// that noise.
fn with_noise(
    rows: &Rows,
    z: &Mat<f64>,
    moments: &Moments,
    metric: MatRef<f64>,
    name: &'static str,
) -> Result<(Estimate, Mat<f64>), DecoupledError> {
    let mut left = None;
    let solved = moments.solve(metric, |parameters| {
        let noise = rows.level(parameters);
        let spread = rows.noise(z, parameters, noise);
        left = Some((noise, spread.clone()));
        spread
    });
    let (solved, (noise, spread)) = solved
        .zip(left)
        .ok_or(DecoupledError::Singular { estimator: name })?;
    Ok((estimate(&solved, noise), spread))
}
