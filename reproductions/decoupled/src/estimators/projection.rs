//! The projection method.

use super::{Estimate, Estimator, RIDGE, TAPS, with_noise};
use crate::DecoupledError;
use crate::joint::Columns;
use crate::moments::{Rows, regularised};
use crate::run::Run;
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

/// The COMAU paper's method (Forssell and Ljung, 2000; its equations 10 to 12): a non-causal filter of the reference estimates
/// the sensitivity from reference to torque; what it gives is the torque without the loop's answer to noise, û = Ŝ r. The model
/// is fitted to û with its columns projected by the same kind of filter, (P τ − P Φ θ)² smallest, so that both sides have the
/// reference's harmonics alone.
///
/// A reference of five harmonics tells eleven of the filter's taps: its normal equations take a small ridge.
pub struct Projection;

impl Estimator for Projection {
    fn name(&self) -> &'static str {
        "projection"
    }

    fn words(&self) -> &'static str {
        "projection method: torque and columns as filters of the reference"
    }

    fn estimate(
        &self,
        run: &Run,
        columns: Columns,
        known: &dyn Fn(usize) -> f64,
    ) -> Result<Estimate, DecoupledError> {
        let rows = Rows::new(run, columns, known);
        let z = rows.lagged(TAPS);
        let metric = regularised(z.transpose() * &z, RIDGE);
        let moments = rows.moments(&z);
        let (mut found, _) = with_noise(&rows, &z, &moments, metric.as_ref(), self.name())?;
        found.correlation = correlation(&z, &metric, &rows.torque);
        Ok(found)
    }
}

/// Correlation of û = Z (Zᵀ Z)⁻¹ Zᵀ τ with τ − û.
fn correlation(z: &Mat<f64>, metric: &Mat<f64>, torque: &Mat<f64>) -> Option<f64> {
    let filter = metric.llt(Side::Lower).ok()?.solve(z.transpose() * torque);
    let projected = z * filter;
    let left = torque - &projected;
    let product = projected.transpose() * &left;
    let size = projected.norm_l2() * left.norm_l2();
    (size > 0.0).then(|| product[(0, 0)] / size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::column;

    /// Torque that is a filter of the reference, and noise: what is left has nothing of the reference.
    #[test]
    fn what_is_left_has_nothing_of_the_reference() {
        let z = Mat::from_fn(500, 3, |k, j| (0.1 * k as f64 + j as f64).sin());
        let noise = |k: usize| ((k * k) as f64).sin();
        let torque = column(
            &(0..500)
                .map(|k| 2.0 * z[(k, 0)] - z[(k, 2)] + noise(k))
                .collect::<Vec<_>>(),
        );
        let metric = regularised(z.transpose() * &z, RIDGE);
        let found = correlation(&z, &metric, &torque).unwrap();
        assert!(found.abs() < 1e-6, "{found}");
    }
}
