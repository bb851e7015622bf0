//! Instrumental variables.

use super::{Estimate, Estimator, with_noise};
use crate::DecoupledError;
use crate::joint::Columns;
use crate::moments::Rows;
use crate::run::Run;
use faer::Mat;

/// Zᵀ W (τ − Φ θ) = 0 with Z the columns at the commanded motion: as many equations as parameters, and the usual alternative
/// in closed loop (Gilson and Van den Hof, Automatica 41(2), 2005).
pub struct Instruments;

impl Estimator for Instruments {
    fn name(&self) -> &'static str {
        "instruments"
    }

    fn words(&self) -> &'static str {
        "instrumental variables: the columns at the commanded motion"
    }

    fn estimate(
        &self,
        run: &Run,
        columns: Columns,
        known: &dyn Fn(usize) -> f64,
    ) -> Result<Estimate, DecoupledError> {
        let rows = Rows::new(run, columns, known);
        let z = rows.commanded();
        // As many equations as unknowns: the metric decides nothing but the rounding.
        let squares = z.transpose() * &z;
        let metric = Mat::from_fn(z.ncols(), z.ncols(), |i, j| {
            if i == j {
                squares[(i, i)].max(f64::MIN_POSITIVE)
            } else {
                0.0
            }
        });
        let moments = rows.moments(&z);
        let (found, _) = with_noise(&rows, &z, &moments, metric.as_ref(), self.name())?;
        Ok(found)
    }
}
