//! Plain least squares.

use super::{Estimate, Estimator};
use crate::DecoupledError;
use crate::joint::Columns;
use crate::moments::differences;
use crate::run::Run;
use identify::least_squares::{Accumulator, SolveOptions, solve};

/// min ‖τ − Φ θ‖² with velocity, acceleration and direction from the recorded position, as it is. Noise of position stands in
/// Φ, and through the controller in τ.
pub struct LeastSquares;

impl Estimator for LeastSquares {
    fn name(&self) -> &'static str {
        "least-squares"
    }

    fn words(&self) -> &'static str {
        "plain least squares on differences of the recorded position"
    }

    fn estimate(
        &self,
        run: &Run,
        columns: Columns,
        known: &dyn Fn(usize) -> f64,
    ) -> Result<Estimate, DecoupledError> {
        let mut rows = Accumulator::new(columns.len());
        let mut row = Vec::new();
        for k in 1..run.len() - 1 {
            let [v, a] = differences(run, k);
            columns.row(run.q[k], v, a, v > 0.0, &mut row);
            rows.push(&row, run.tau[k] - known(k), 1.0)?;
        }
        let found = solve(&rows.finish()?, &SolveOptions::default())?;
        Ok(Estimate {
            parameters: found.parameters,
            std: found.std,
            noise: None,
            correlation: None,
        })
    }
}
