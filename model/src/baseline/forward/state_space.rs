//! Discrete linear state spaces.

use ndarray::{Array1, Array2, ArrayView2};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// x(k+1) = A x(k) + B u(k), y(k) = C x(k) + D u(k); matrices as lists of rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StateSpace {
    /// System matrix A, n × n with n states.
    pub a: Vec<Vec<f64>>,
    /// Input matrix B, n × inputs.
    pub b: Vec<Vec<f64>>,
    /// Output matrix C, outputs × n.
    pub c: Vec<Vec<f64>>,
    /// Feedthrough matrix D, outputs × inputs.
    pub d: Vec<Vec<f64>>,
}

impl StateSpace {
    /// Number of states n.
    pub fn order(&self) -> usize {
        self.a.len()
    }

    /// Outputs (samples, outputs) for inputs (samples, inputs). The state is zero at the start of each
    /// trajectory; rows outside of all trajectories are zero.
    ///
    /// # Panics
    /// If a trajectory reaches beyond the inputs, or the inputs are fewer than B has columns.
    pub fn simulate(&self, u: ArrayView2<f64>, trajectories: &[Range<usize>]) -> Array2<f64> {
        let (n, outputs) = (self.order(), self.c.len());
        let (a, b) = (matrix(&self.a, n), matrix(&self.b, u.ncols()));
        let (c, d) = (matrix(&self.c, n), matrix(&self.d, u.ncols()));
        let mut y = Array2::zeros((u.nrows(), outputs));
        for trajectory in trajectories {
            let mut x = Array1::<f64>::zeros(n);
            for k in trajectory.clone() {
                let input = u.row(k);
                y.row_mut(k).assign(&(c.dot(&x) + d.dot(&input)));
                x = a.dot(&x) + b.dot(&input);
            }
        }
        y
    }
}

fn matrix(rows: &[Vec<f64>], columns: usize) -> Array2<f64> {
    Array2::from_shape_fn((rows.len(), columns), |(i, j)| rows[i][j])
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn a_step_by_hand_and_a_restart_at_every_trajectory() {
        // x₁ = 0, x₂ = 2, x₃ = 0.5·2 + 2 = 3; y = x + 0.1 u.
        let rows = |v: f64| vec![vec![v]];
        let system = StateSpace {
            a: rows(0.5),
            b: rows(2.0),
            c: rows(1.0),
            d: rows(0.1),
        };
        let u = array![[1.0], [1.0], [1.0], [1.0], [1.0]];
        let y = system.simulate(u.view(), &[0..3, 3..5]);
        assert_eq!(y, array![[0.1], [2.1], [3.1], [0.1], [2.1]]);
    }
}
