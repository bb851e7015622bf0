//! How long what a search leaves remembers itself: so many rows say no more than one that is independent.

use ndarray::Array2;
use signal::correlation::correlation_time;
use signal::quantile::median;
use std::ops::Range;

/// Rows for which each joint's residual remembers itself, the median over trajectories of its integrated correlation time. `left` and
/// `weight` of shape (rows, joints).
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
            correlation_time(&[&own])
        };
        median(trajectories.iter().map(one).collect()).unwrap_or(1.0)
    };
    (0..left.ncols()).map(of).collect()
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
}
