//! Motions designed without a model: the KR300 benchmark's experiments.
//!
//! Its eqs 1 and 2: a sum of sines and cosines of random coefficients over ten frequencies between the base
//! frequency 1/60 Hz and 1 Hz. Position (home), velocity, acceleration and jerk are given at both ends, limits
//! up to jerk are kept, and there is no criterion. The paper leaves the constraints to a solver whose random
//! start makes each trajectory another. Here the coefficients are drawn, projected onto the constraints and
//! shrunk into the limits, which does the same in one step. The paper's 60.6 s are taken as the base period, so
//! that the end is the start.

use super::room::Room;
use super::search::filling;
use super::series::Series;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Length of a trajectory, s (benchmark, section 2.1).
pub const DURATION: f64 = 60.6;
/// Number of trajectories in the KR300 benchmark.
pub const TRAJECTORIES: usize = 36;
/// Least share of the limits. A motion fills a random share, from this to 1, of the first limit that a joint meets. So
/// slow motions occur as well: the benchmark's authors found that effects which are hard to model show there.
const LEAST_SHARE: f64 = 0.4;

/// Ten multiples of the base frequency up to the `highest`, in even ratios: which ten of the grid up to 1 Hz the benchmark
/// took is not in its text.
pub fn harmonics(highest: usize) -> Vec<usize> {
    const TERMS: usize = 10;
    let ratio = (highest.max(1) as f64).powf(1.0 / (TERMS - 1) as f64);
    let mut all: Vec<usize> = Vec::with_capacity(TERMS);
    for i in 0..TERMS {
        let even = ratio.powi(i as i32).round() as usize;
        let next = all.last().map_or(1, |last| last + 1);
        all.push(even.max(next));
    }
    all.retain(|h| *h <= highest);
    all
}

/// One random motion in a room.
pub fn model_free(room: &Room, seed: u64) -> Series {
    filling(room, &mut ChaCha8Rng::seed_from_u64(seed), LEAST_SHARE)
}
