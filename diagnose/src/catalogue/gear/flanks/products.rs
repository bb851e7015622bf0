//! Sums of products of columns, and least squares from them.

use crate::algebra::cholesky::Cholesky;
use ndarray::{Array1, Array2};

/// Sums of products of columns with each other (lower triangle), and with the measured values.
#[derive(Clone)]
pub(super) struct Products {
    gram: Array2<f64>,
    right: Array1<f64>,
}

impl Products {
    /// Empty sums for `n` columns.
    pub(super) fn new(n: usize) -> Self {
        Self {
            gram: Array2::zeros((n, n)),
            right: Array1::zeros(n),
        }
    }

    /// Adds one row and its measured value.
    pub(super) fn row(&mut self, row: &[f64], measured: f64) {
        for (a, x) in row.iter().enumerate() {
            for (b, y) in row[..=a].iter().enumerate() {
                self.gram[[a, b]] += x * y;
            }
            self.right[a] += x * measured;
        }
    }

    /// Adds the sums of other rows, times a factor.
    pub(super) fn add(&mut self, other: &Self, factor: f64) {
        self.gram.scaled_add(factor, &other.gram);
        self.right.scaled_add(factor, &other.right);
    }

    /// Least-squares coefficients.
    pub(super) fn solve(&self) -> Option<Vec<f64>> {
        let x = Cholesky::new(&self.gram).solve(self.right.view());
        x.iter().all(|x| x.is_finite()).then(|| x.to_vec())
    }

    /// Sums with one coefficient tied to zero by a penalty.
    pub(super) fn held(&self, (column, tie): (usize, f64)) -> Self {
        let mut own = self.clone();
        own.gram[[column, column]] += tie;
        own
    }

    /// Variance of a coefficient for residuals of unit variance.
    pub(super) fn variance(&self, of: usize) -> Option<f64> {
        let variance = Cholesky::new(&self.gram).inverse_diagonal()[of];
        variance.is_finite().then_some(variance)
    }
}
