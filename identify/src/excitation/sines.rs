//! One sine per joint, of frequencies without whole ratios: the softMC manual's identification motion.
//!
//! Its rules: every joint completes at least three periods. Its amplitude is close to its range of positions
//! and its speed close to its limit. No joint's frequency is equal to another's or a whole multiple of it, and
//! the motion of all does not repeat while it is recorded. Its program starts the sines at full acceleration;
//! here the path has a smooth start and a smooth stop, so that the motion starts and ends at rest.

use super::error::ExcitationError;
use super::room::Bounds;
use super::search::Found;
use super::series::{Series, gathering};
use ndarray::Array2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Settings of the design [`sines`].
#[derive(Debug, Clone, PartialEq)]
pub struct SineOptions {
    /// Length of the motion, s; none: as long as it takes, in whole seconds.
    pub duration: Option<f64>,
    /// Least number of periods of every joint. Default 3.
    pub cycles: f64,
    /// Highest frequency, Hz; none for the highest within the limits.
    pub highest_hz: Option<f64>,
    /// Number of random phases and orders that are judged. Default 200.
    pub draws: usize,
    /// Seed of the random phases and orders.
    pub seed: u64,
}

impl Default for SineOptions {
    fn default() -> Self {
        Self {
            duration: None,
            cycles: 3.0,
            highest_hz: None,
            draws: 200,
            seed: 1,
        }
    }
}

/// Duration of the smooth start, in radians of the slowest sine.
const RAMP: f64 = 2.0;
/// Steps over the start on which its accelerations are bounded, and the factor that covers the time between the steps.
const STEPS: usize = 400;
const BETWEEN: f64 = 1.002;
/// Factor by which a frequency that does not fit is lowered, and the largest number of such steps.
const LOWER: f64 = 0.99;
const TRIES: usize = 200;
/// Lowest frequency of any joint over the lowest that the limits allow: room for ratios where joints have like limits.
const SLOWEST: f64 = 0.5;
/// Distance of the ratio of two frequencies from a whole number.
const APART: f64 = 0.08;
/// Part of a period within which all joints are back where they were: the motion repeats.
const REPEATS: f64 = 0.03;

/// The best by `cost` of random phases, and of the order in which joints choose their frequencies.
///
/// # Errors
/// Limits, home or region that leave no motion, a time too short for the periods, errors of `cost`.
pub fn sines(
    bounds: &Bounds,
    options: &SineOptions,
    cost: impl Fn(&Series) -> Result<f64, ExcitationError> + Sync,
) -> Result<Found, ExcitationError> {
    if options.draws == 0 {
        return Err(ExcitationError::Empty("the number of draws"));
    }
    let anchor = bounds.anchor(options.seed)?;
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    let (mut draws, mut refused) = (Vec::new(), None);
    for _ in 0..options.draws {
        match draw(bounds, options, &anchor, &mut rng) {
            Ok(series) => draws.push(series),
            Err(error) => refused = refused.or(Some(error)),
        }
    }
    if let (true, Some(error)) = (draws.is_empty(), refused) {
        return Err(error);
    }
    let costs: Vec<f64> = draws.par_iter().map(&cost).collect::<Result<_, _>>()?;
    let least = (0..costs.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b]));
    let best = least.expect("there is a draw");
    if !costs[best].is_finite() {
        return Err(ExcitationError::NothingFound);
    }
    Ok(Found {
        trajectory: draws[best].clone(),
        cost: costs[best],
        start_cost: costs[0],
        evaluations: costs.len(),
    })
}

fn draw(
    bounds: &Bounds,
    options: &SineOptions,
    anchor: &[f64],
    rng: &mut ChaCha8Rng,
) -> Result<Series, ExcitationError> {
    let n = bounds.limits.len();
    let mut order: Vec<usize> = (0..n).collect();
    for i in (1..n).rev() {
        order.swap(i, rng.random_range(0..=i));
    }
    let tops: Vec<f64> = bounds
        .limits
        .iter()
        .map(|l| {
            let a = l.half();
            let highest = options.highest_hz.map_or(f64::INFINITY, |f| TAU * f);
            let by = [
                l.velocity / a,
                (l.acceleration / a).sqrt(),
                (l.jerk / a).cbrt(),
                highest,
            ];
            by.into_iter().fold(f64::INFINITY, f64::min)
        })
        .collect();
    let slowest = SLOWEST * tops.iter().copied().fold(f64::INFINITY, f64::min);
    let ramp = RAMP / slowest;
    let mut pulsation = vec![0.0; n];
    let mut chosen: Vec<f64> = Vec::new();
    for &j in &order {
        let l = &bounds.limits[j];
        let fits = |w: f64| {
            let [acceleration, jerk] = ramp_bounds(w, ramp);
            l.half() * acceleration <= l.acceleration && l.half() * jerk <= l.jerk
        };
        let candidates = (0..TRIES).map(|k| tops[j] * LOWER.powi(k as i32));
        let mut candidates = candidates.filter(|w| *w >= slowest);
        let found = candidates.find(|&w| fits(w) && chosen.iter().all(|&c| apart(w, c)));
        pulsation[j] = found.ok_or(ExcitationError::Commensurate { joint: j })?;
        chosen.push(pulsation[j]);
    }
    let time = |w: f64| options.cycles * TAU / w + ramp;
    let needed = pulsation.iter().map(|&w| time(w)).fold(0.0, f64::max);
    let duration = options.duration.unwrap_or_else(|| needed.ceil());
    if duration < needed {
        let slowest = (0..n).min_by(|&a, &b| pulsation[a].total_cmp(&pulsation[b]));
        let joint = slowest.unwrap_or(0);
        return Err(ExcitationError::FewCycles {
            joint,
            cycle: TAU / pulsation[joint],
            cycles: options.cycles,
            needed,
            duration,
        });
    }
    if repeats(&pulsation, duration - ramp) {
        let last = order.last().copied().unwrap_or(0);
        return Err(ExcitationError::Commensurate { joint: last });
    }
    let phase: Vec<f64> = (0..n)
        .map(|j| {
            let l = &bounds.limits[j];
            match &bounds.home {
                Some(home) => {
                    let sine = ((home[j] - l.middle()) / l.half()).clamp(-1.0, 1.0);
                    let turned = rng.random_range(0.0..1.0) < 0.5;
                    if turned {
                        PI - sine.asin()
                    } else {
                        sine.asin()
                    }
                }
                None => rng.random_range(0.0..TAU),
            }
        })
        .collect();
    let one = |f: &dyn Fn(usize) -> f64| Array2::from_shape_fn((n, 1), |(j, _)| f(j));
    let half = |j: usize| bounds.limits[j].half();
    let mut series = Series {
        duration,
        ramp,
        offset: bounds.limits.iter().map(|l| l.middle()).collect(),
        pulsation: one(&|j| pulsation[j]),
        sine: one(&|j| half(j) * phase[j].cos()),
        cosine: one(&|j| half(j) * phase[j].sin()),
    };
    if let Some(tool) = &bounds.tool {
        tool.keep(&mut series, anchor);
    }
    Ok(series)
}

/// Largest acceleration and jerk over the amplitude, 1/s² and 1/s³, of a sine with a smooth start of `ramp` seconds.
///
/// With q = sin(ωs): q̈ = −ω²ṡ² sin + ωs̈ cos and jerk = −(ω³ṡ³ − ωs⃛) cos − 3ω²ṡs̈ sin, each a sine of the
/// phase, whose amplitude bounds it for every phase.
fn ramp_bounds(w: f64, ramp: f64) -> [f64; 2] {
    let mut most = [w * w, w * w * w];
    for k in 0..=STEPS {
        let [_, s1, s2, s3] = gathering(ramp * k as f64 / STEPS as f64, ramp);
        let acceleration = (w * w * s1 * s1).hypot(w * s2);
        let jerk = (w * w * w * s1 * s1 * s1 - w * s3).hypot(3.0 * w * w * s1 * s2);
        most[0] = most[0].max(BETWEEN * acceleration);
        most[1] = most[1].max(BETWEEN * jerk);
    }
    most
}

/// Whether two frequencies differ and neither is close to a whole multiple of the other.
fn apart(a: f64, b: f64) -> bool {
    let ratio = a.max(b) / a.min(b);
    (ratio - ratio.round()).abs() >= APART
}

/// Whether all joints are back at their phases at once within `length` seconds of path.
pub(super) fn repeats(pulsation: &[f64], length: f64) -> bool {
    let Some(slowest) = pulsation.iter().copied().reduce(f64::min) else {
        return false;
    };
    if pulsation.len() < 2 {
        return false;
    }
    let cycles = (slowest * length / TAU).floor() as usize;
    (1..=cycles).any(|m| {
        let back = |w: &f64| {
            let turns = m as f64 * w / slowest;
            (turns - turns.round()).abs() < REPEATS
        };
        pulsation.iter().all(back)
    })
}
