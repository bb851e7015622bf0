//! Bootstrap intervals of quantities from autocorrelated series.

use crate::quantile::quantile;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Number of resamples of the bootstrap.
const DRAWS: u64 = 200;

/// Σ part / Σ whole over blocks (part, whole) of a series, with its 90 % interval by the block bootstrap
/// (Künsch 1989): blocks, long enough to be independent, are drawn with replacement. The interval includes the
/// value; both are zero where the wholes are zero. The same blocks give the same interval on every machine.
pub fn ratio(blocks: &[(f64, f64)]) -> (f64, [f64; 2]) {
    let of = |sum: (f64, f64)| if sum.1 > 0.0 { sum.0 / sum.1 } else { 0.0 };
    let add = |sum: (f64, f64), b: &(f64, f64)| (sum.0 + b.0, sum.1 + b.1);
    let value = of(blocks.iter().fold((0.0, 0.0), add));
    let draw = |seed| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let drawn = (0..blocks.len()).map(|_| &blocks[random.random_range(0..blocks.len())]);
        of(drawn.fold((0.0, 0.0), add))
    };
    let draws: Vec<f64> = (0..DRAWS).map(draw).collect();
    let end = |p| quantile(draws.clone(), p).unwrap_or(value);
    (value, [end(0.05).min(value), end(0.95).max(value)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_is_that_of_the_mean_of_independent_blocks() {
        // Halves of ones and zeros: the mean of 400 has the deviation 0.5/√400 = 0.025.
        let blocks: Vec<(f64, f64)> = (0..400).map(|i| (f64::from(i % 2), 1.0)).collect();
        let (value, [low, high]) = ratio(&blocks);
        assert_eq!(value, 0.5);
        let expected = 1.645 * 0.025;
        assert!((value - low - expected).abs() < 0.01, "{low}");
        assert!((high - value - expected).abs() < 0.01, "{high}");
    }

    #[test]
    fn nothing_has_no_share() {
        assert_eq!(ratio(&[]), (0.0, [0.0, 0.0]));
        assert_eq!(ratio(&[(0.0, 0.0)]), (0.0, [0.0, 0.0]));
    }
}
