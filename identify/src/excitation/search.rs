//! Coordinate search from random starts.

use super::{ExcitationError, Fourier, MotionLimits};
use ndarray::Array2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Settings of [`optimise`].
#[derive(Debug, Clone, PartialEq)]
pub struct SearchOptions {
    /// Period, s. Default 12.5 (0.08 Hz; with five harmonics 0.4 Hz, the highest frequency of Han et al.).
    pub period: f64,
    /// Harmonics of each joint. Default 5.
    pub harmonics: usize,
    /// Random starts. Default 10.
    pub starts: usize,
    /// Sweeps over all coefficients of the best start; the step halves after each. Default 4.
    pub sweeps: usize,
    /// Seed of the starts.
    pub seed: u64,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self {
            period: 12.5,
            harmonics: 5,
            starts: 10,
            sweeps: 4,
            seed: 1,
        }
    }
}

/// What [`optimise`] found.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The best trajectory; it keeps all limits at all times.
    pub trajectory: Fourier,
    /// Its cost.
    pub cost: f64,
    /// Cost of the best random start.
    pub start_cost: f64,
    /// Trajectories judged.
    pub evaluations: usize,
}

/// The trajectory of least `cost` found within `limits` (one per joint): the best of the random starts, improved one
/// coefficient at a time.
///
/// # Errors
/// Limits that leave no motion, options that leave nothing to search, errors of `cost`.
pub fn optimise(
    limits: &[MotionLimits],
    options: &SearchOptions,
    mut cost: impl FnMut(&Fourier) -> Result<f64, ExcitationError>,
) -> Result<Found, ExcitationError> {
    let (n, h) = (limits.len(), options.harmonics);
    for (what, ok) in [
        ("the number of joints", n > 0),
        ("the number of harmonics", h > 0),
        ("the number of starts", options.starts > 0),
        (
            "the period",
            options.period.is_finite() && options.period > 0.0,
        ),
    ] {
        if !ok {
            return Err(ExcitationError::Empty(what));
        }
    }
    for (joint, limit) in limits.iter().enumerate() {
        limit.check(joint)?;
    }
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    let mut best: Option<(Fourier, f64)> = None;
    for _ in 0..options.starts {
        let trajectory = random(limits, options, &mut rng);
        let value = cost(&trajectory)?;
        if best.as_ref().is_none_or(|(_, least)| value < *least) {
            best = Some((trajectory, value));
        }
    }
    let Some((mut trajectory, mut least)) = best else {
        return Err(ExcitationError::Empty("the number of finite costs"));
    };
    let (start_cost, mut evaluations) = (least, options.starts);
    let mut step = 0.25;
    for _ in 0..options.sweeps {
        for joint in 0..n {
            let half = 0.5 * (limits[joint].upper - limits[joint].lower);
            for coefficient in 0..2 * h + 1 {
                for direction in [step, -step] {
                    let mut trial = trajectory.clone();
                    let entry = match coefficient {
                        0 => &mut trial.offset[joint],
                        c if c <= h => &mut trial.sine[(joint, c - 1)],
                        c => &mut trial.cosine[(joint, c - h - 1)],
                    };
                    *entry += direction * half;
                    trial.keep(limits);
                    evaluations += 1;
                    let value = cost(&trial)?;
                    if value < least {
                        (trajectory, least) = (trial, value);
                        break;
                    }
                }
            }
        }
        step *= 0.5;
    }
    Ok(Found {
        trajectory,
        cost: least,
        start_cost,
        evaluations,
    })
}

/// Random coefficients that fill the limits.
fn random(limits: &[MotionLimits], options: &SearchOptions, rng: &mut ChaCha8Rng) -> Fourier {
    let shape = (limits.len(), options.harmonics);
    let mut draw = |joint: usize, scale: f64| {
        let half = 0.5 * (limits[joint].upper - limits[joint].lower);
        rng.random_range(-scale..scale) * half
    };
    let sine = Array2::from_shape_fn(shape, |(joint, _)| draw(joint, 1.0));
    let cosine = Array2::from_shape_fn(shape, |(joint, _)| draw(joint, 1.0));
    let offset = (0..limits.len())
        .map(|joint| 0.5 * (limits[joint].lower + limits[joint].upper) + draw(joint, 0.3))
        .collect();
    let mut trajectory = Fourier {
        period: options.period,
        offset,
        sine,
        cosine,
    };
    trajectory.keep(limits);
    trajectory
}
