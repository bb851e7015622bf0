//! Sums of products of columns, and what follows from them.

use signal::cholesky;

/// Sums of products.
#[derive(Clone)]
pub(super) struct Products {
    gram: Vec<f64>,
    right: Vec<f64>,
}

impl Products {
    /// No rows yet, of `n` columns.
    pub(super) fn new(n: usize) -> Self {
        Self {
            gram: vec![0.0; n * n],
            right: vec![0.0; n],
        }
    }

    /// Adds one row and what was measured there.
    pub(super) fn row(&mut self, row: &[f64], measured: f64) {
        let n = row.len();
        for a in 0..n {
            for b in 0..=a {
                self.gram[a * n + b] += row[a] * row[b];
            }
            self.right[a] += row[a] * measured;
        }
    }

    /// Adds those of other rows, by a factor.
    pub(super) fn add(&mut self, other: &Self, factor: f64) {
        let sum = |a: &mut [f64], b: &[f64]| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
        };
        sum(&mut self.gram, &other.gram);
        sum(&mut self.right, &other.right);
    }

    /// Factor of the scaled system, one column held at none so firmly, and its scales; a column that is nothing, or a copy, is pinned.
    fn factor(&self, (held, tie): (usize, f64)) -> (Vec<f64>, Vec<f64>) {
        let n = self.right.len();
        let mut gram = self.gram.clone();
        gram[held * n + held] += tie;
        let scale: Vec<f64> = (0..n)
            .map(|i| gram[i * n + i].max(f64::MIN_POSITIVE).sqrt())
            .collect();
        for i in 0..n {
            for j in 0..n {
                gram[i * n + j] /= scale[i] * scale[j];
            }
            gram[i * n + i] += 1e-10;
        }
        cholesky::factor_above(&mut gram, n, 1e-12);
        (gram, scale)
    }

    /// Coefficients; one column is held at none so firmly.
    pub(super) fn solve(&self, tied: (usize, f64)) -> Option<Vec<f64>> {
        let (factor, scale) = self.factor(tied);
        let mut x: Vec<f64> = self.right.iter().zip(&scale).map(|(r, s)| r / s).collect();
        cholesky::solve(&factor, &mut x);
        x.iter_mut().zip(&scale).for_each(|(x, s)| *x /= s);
        x.iter().all(|x| x.is_finite()).then_some(x)
    }

    /// Variance of a coefficient for residuals of unit variance.
    pub(super) fn variance(&self, tied: (usize, f64), of: usize) -> Option<f64> {
        let (factor, scale) = self.factor(tied);
        let mut x = vec![0.0; scale.len()];
        x[of] = 1.0;
        cholesky::solve(&factor, &mut x);
        Some(x[of] / (scale[of] * scale[of])).filter(|v| v.is_finite() && *v >= 0.0)
    }
}
