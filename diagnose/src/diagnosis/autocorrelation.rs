//! Autocorrelation time of a search's residual: so many rows count as one independent sample.

use ndarray::Array2;
use signal::correlation::correlation_time;
use signal::quantile::median;
use std::ops::Range;

/// Autocorrelation time of each joint's residual, rows, median over trajectories: its integrated
/// autocorrelation time. Or that of its square times (κ − 1)/2, where that is longer; κ is the kurtosis, and
/// the factor is 1 for normal noise. An error that is concentrated at the reversals is a law that is not quite
/// right, and counts as many samples as there are reversals. `left` and `weight` of shape (rows, joints).
pub(super) fn of_joints(
    left: &Array2<f64>,
    weight: &Array2<f64>,
    trajectories: &[Range<usize>],
) -> Vec<f64> {
    let of = |j: usize| {
        // Rows count as much as they do in a fit.
        let weighed = |i: usize| left[[i, j]] * weight[[i, j]].sqrt();
        let one = |rows: &Range<usize>| {
            let own: Vec<f64> = rows.clone().map(weighed).collect();
            correlation_time(&[&own]).max(of_squares(&own))
        };
        median(trajectories.iter().map(one).collect()).unwrap_or(1.0)
    };
    (0..left.ncols()).map(of).collect()
}

/// Number of rows that determine the mean square as well as one row of white normal noise.
fn of_squares(left: &[f64]) -> f64 {
    let squares: Vec<f64> = left.iter().map(|x| x * x).collect();
    let count = squares.len().max(1) as f64;
    let mean = squares.iter().sum::<f64>() / count;
    let variance = squares.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / count;
    correlation_time(&[&squares]) * variance / (2.0 * mean * mean).max(1e-300)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn white_noise_forgets_at_once_and_an_autoregression_as_its_pole_says() {
        let n = 40_000;
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let mut left = Array2::zeros((n, 2));
        let mut last = 0.0;
        for i in 0..n {
            let white = rng.random::<f64>() - 0.5;
            last = 0.9 * last + white;
            left[[i, 0]] = white;
            left[[i, 1]] = last;
        }
        let weight = Array2::from_elem((n, 2), 1.0);
        let memory = of_joints(&left, &weight, &[0..n / 2, n / 2..n]);
        assert!(memory[0] < 1.3, "{memory:?}");
        // (1 + a)/(1 - a) of a pole at a.
        assert!((memory[1] / 19.0 - 1.0).abs() < 0.15, "{memory:?}");
    }

    #[test]
    fn an_error_that_is_all_in_few_places_says_little() {
        let n = 10_000;
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(6);
        let left = Array2::from_shape_fn((n, 1), |(i, _)| {
            let size = if i % 100 < 4 { 1.0 } else { 0.02 };
            size * (rng.random::<f64>() - 0.5)
        });
        let weight = Array2::from_elem((n, 1), 1.0);
        let memory = of_joints(&left, &weight, &[0..n / 2, n / 2..n]);
        // Kurtosis of a twenty-fifth of uniform noise is 25 · 1.8, and four rows in a row are large.
        assert!(memory[0] > 30.0, "{memory:?}");
    }
}
