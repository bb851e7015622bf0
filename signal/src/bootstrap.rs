//! Resampling of autocorrelated series.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Indices of a moving-block bootstrap sample (Künsch 1989): blocks of `block` consecutive samples
/// drawn with replacement until `samples` indices are there.
///
/// The same seed gives the same indices on every machine. A block is cut to the series; no samples
/// give no indices.
pub fn block_bootstrap(samples: usize, block: usize, seed: u64) -> Vec<usize> {
    if samples == 0 {
        return Vec::new();
    }
    let block = block.clamp(1, samples);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut indices = Vec::with_capacity(samples + block);
    while indices.len() < samples {
        let start = random.random_range(0..=samples - block);
        indices.extend(start..start + block);
    }
    indices.truncate(samples);
    indices
}
