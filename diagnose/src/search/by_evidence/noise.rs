//! Noise of one joint's rows: white noise plus a slow discrepancy, and the rows whitened by it.
//!
//! The discrepancy is an Ornstein-Uhlenbeck process, which a Kalman filter of one state predicts row by row. The
//! innovations of a column, each over its deviation, are the column times the inverse Cholesky factor of the noise's
//! covariance (Särkkä & Solin, 2019, chapter 10). It costs time linear in the rows.

use ndarray::{Array1, ArrayView1};
use std::ops::Range;

/// Correlation times of the discrepancy that are tried, rows. The longest is a second at the usual 62.5 rows a second.
const TIMES: [f64; 6] = [2.0, 4.0, 8.0, 16.0, 32.0, 64.0];
/// Variances of the discrepancy over that of the white noise that are tried.
const RATIOS: [f64; 9] = [0.0, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 16.0, 64.0];

/// Shape of a joint's noise: its covariance up to one factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    /// Correlation time of the discrepancy, rows.
    pub time: f64,
    /// Variance of the discrepancy over that of the white noise.
    pub ratio: f64,
}

/// Filter that whitens rows whose noise has a given shape.
pub(super) struct Whitener<'a> {
    /// Rows of each trajectory.
    runs: &'a [Range<usize>],
    /// Part of the state that is left one row later.
    kept: f64,
    /// Gain of each row, and its innovation's inverse deviation; zero both at rows of no weight.
    gains: Vec<(f64, f64)>,
    /// Logarithm of the determinant of the noise's covariance.
    pub log_determinant: f64,
    /// Number of rows with weight.
    pub rows: usize,
}

impl<'a> Whitener<'a> {
    /// Filter for a noise of `shape`. `weight` divides the white noise's variance by row; a row of weight zero is left
    /// out. The trajectories `runs` are independent of each other.
    pub(super) fn new(shape: Shape, weight: ArrayView1<f64>, runs: &'a [Range<usize>]) -> Self {
        let kept = (-1.0 / shape.time).exp();
        let mut gains = vec![(0.0, 0.0); weight.len()];
        let (mut log_determinant, mut rows) = (0.0, 0);
        for run in runs {
            let mut variance = shape.ratio;
            for i in run.clone() {
                if weight[i] > 0.0 {
                    let all = variance + 1.0 / weight[i];
                    gains[i] = (variance / all, all.sqrt().recip());
                    variance *= 1.0 - gains[i].0;
                    log_determinant += all.ln();
                    rows += 1;
                }
                variance = kept * kept * variance + shape.ratio * (1.0 - kept * kept);
            }
        }
        Self {
            runs,
            kept,
            gains,
            log_determinant,
            rows,
        }
    }

    /// Whitened rows of a column; zero at rows of no weight.
    pub(super) fn whiten(&self, column: ArrayView1<f64>) -> Array1<f64> {
        let mut out = Array1::zeros(column.len());
        for run in self.runs {
            let mut state = 0.0;
            for i in run.clone() {
                let (gain, root) = self.gains[i];
                let innovation = column[i] - state;
                out[i] = innovation * root;
                state = self.kept * (state + gain * innovation);
            }
        }
        out
    }
}

/// Shape under which a residual is likeliest, its factor profiled.
pub(super) fn likeliest(
    residual: ArrayView1<f64>,
    weight: ArrayView1<f64>,
    runs: &[Range<usize>],
) -> Shape {
    let all = TIMES.iter().flat_map(|&time| {
        let each = RATIOS.iter();
        each.map(move |&ratio| Shape { time, ratio })
    });
    let surprise = |shape: Shape| {
        let whitener = Whitener::new(shape, weight, runs);
        let white = whitener.whiten(residual);
        let n = whitener.rows as f64;
        let square = white.dot(&white).max(f64::MIN_POSITIVE);
        let surprise = 0.5 * n * (square / n.max(1.0)).ln() + 0.5 * whitener.log_determinant;
        (surprise, shape)
    };
    let best = all.map(surprise).min_by(|a, b| a.0.total_cmp(&b.0));
    best.expect("the grids are not empty").1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::cholesky::Cholesky;
    use ndarray::Array2;
    use rand::{RngExt as _, SeedableRng as _};

    /// Whitened products are those with the inverse of the covariance, written out.
    #[test]
    fn whitened_products_are_those_of_the_covariance() {
        let shape = Shape {
            time: 3.0,
            ratio: 2.0,
        };
        let runs = [0..5, 5..9];
        let weight = Array1::from(vec![1.0, 0.5, 1.0, 0.25, 1.0, 1.0, 1.0, 0.5, 1.0]);
        let together = |i: usize, k: usize| runs.iter().any(|r| r.contains(&i) && r.contains(&k));
        let covariance = Array2::from_shape_fn((9, 9), |(i, k)| {
            let slow = 2.0 * (-(i.abs_diff(k) as f64) / 3.0).exp();
            let white = if i == k { 1.0 / weight[i] } else { 0.0 };
            white + if together(i, k) { slow } else { 0.0 }
        });
        let [x, y] = [0.7, 1.9].map(|w| Array1::from_shape_fn(9, |i| (w * i as f64).sin() + 0.3));
        let exact = Cholesky::new(&covariance);
        let whitener = Whitener::new(shape, weight.view(), &runs);
        let product = whitener.whiten(x.view()).dot(&whitener.whiten(y.view()));
        assert!((product - x.dot(&exact.solve(y.view()))).abs() < 1e-12);
        assert!((whitener.log_determinant - exact.log_determinant()).abs() < 1e-12);
    }

    #[test]
    fn the_likeliest_shape_is_near_that_of_the_noise() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        let mut normal = || (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
        let kept = (-1.0_f64 / 16.0).exp();
        let mut slow = 0.0;
        let residual = Array1::from_shape_fn(20_000, |_| {
            slow = kept * slow + (1.0 - kept * kept).sqrt() * normal();
            slow + normal()
        });
        let weight = Array1::ones(residual.len());
        let found = likeliest(
            residual.view(),
            weight.view(),
            std::slice::from_ref(&(0..20_000)),
        );
        assert_eq!((found.time, found.ratio), (16.0, 1.0));
    }
}
