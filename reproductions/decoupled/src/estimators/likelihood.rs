//! Maximum likelihood with noise of position and of torque.

use super::{Estimate, Estimator, RIDGE, TAPS, with_noise};
use crate::DecoupledError;
use crate::joint::Columns;
use crate::moments::{Rows, regularised};
use crate::run::Run;

/// Passes in which S(θ) follows the parameters.
const PASSES: usize = 4;
/// Ridge of S² relative to its mean diagonal, which spans the reference's harmonics alone.
const NOISE_RIDGE: f64 = 1e-9;

/// The COMAU paper's second stage (its equations 13 to 16): θ = argmin bᵀ S(θ)⁻² b, b what the model leaves of the projected
/// equations and S² = B σ² Bᵀ its covariance by noise of position and of torque, B the slopes of the equations by the samples.
/// Deviations are those of equation 16, (Aᵀ S⁻² A)⁻¹.
pub struct MaximumLikelihood;

impl Estimator for MaximumLikelihood {
    fn name(&self) -> &'static str {
        "likelihood"
    }

    fn words(&self) -> &'static str {
        "maximum likelihood of the projected equations"
    }

    fn estimate(
        &self,
        run: &Run,
        columns: Columns,
        known: &dyn Fn(usize) -> f64,
    ) -> Result<Estimate, DecoupledError> {
        let rows = Rows::new(run, columns, known);
        let z = rows.lagged(TAPS);
        let moments = rows.moments(&z);
        let mut metric = regularised(z.transpose() * &z, RIDGE);
        let mut found = None;
        for _ in 0..PASSES {
            let (estimate, spread) = with_noise(&rows, &z, &moments, metric.as_ref(), self.name())?;
            metric = regularised(spread, NOISE_RIDGE);
            found = Some(estimate);
        }
        found.ok_or(DecoupledError::Singular {
            estimator: self.name(),
        })
    }
}
