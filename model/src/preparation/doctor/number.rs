//! Statistics of the recorded numbers themselves, without any model.

use datasets::Recording;
use datasets::check::{moves, plateau};
use signal::quantile::{median, quantile};
use std::ops::Range;

/// Orders of the differences from which the noise is estimated. Higher orders contain less of the motion.
const ORDERS: Range<usize> = 3..8;
/// Order of the differences that show corners of the torque.
const CORNER: usize = 6;
/// Part of the gaps between neighbouring values that must be whole numbers of steps, for the values to be on a grid.
const ON_GRID: f64 = 0.97;
/// Part of a step by which a gap may differ from a whole number of steps.
const OFF_GRID: f64 = 0.02;
/// Speed above which a joint counts as moving, as a part of its largest speed.
const MOVING: f64 = 0.05;

/// Statistics of the recorded numbers of one joint's torque.
#[derive(Clone, Debug)]
pub(super) struct Numbers {
    /// Root mean square of the torque about its mean, in the recorded unit.
    pub spread: f64,
    /// Largest absolute value of the torque, in the recorded unit.
    pub largest: f64,
    /// Step of the grid that all values are on, in the recorded unit; none where they are on no grid.
    pub step: Option<f64>,
    /// Standard deviation of the torque's white noise, in the recorded unit.
    pub noise: f64,
    /// Largest difference of high order, scaled like `noise`: how sharp the sharpest corner of the torque is.
    pub corner: f64,
    /// Part of the samples in motion at a flat top of |τ|; 0 where there is none.
    pub flat: f64,
    /// Part of the samples below zero by more than a hundredth of the largest magnitude.
    pub negative: f64,
    /// Longest run of one constant value during motion: as a part of the time in motion, and in seconds.
    pub frozen: (f64, f64),
}

impl Numbers {
    /// Numbers of one joint's torque; none where no torque is recorded.
    pub fn of(recording: &Recording, joint: usize) -> Option<Self> {
        let values = recording.tau.as_ref()?.column(joint).to_vec();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let spread = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt();
        let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let below = values.iter().filter(|v| **v < -0.01 * largest).count();
        let moving = moving(recording, joint);
        Some(Self {
            spread,
            largest,
            step: step(&values),
            noise: noise(&values, &recording.segments()),
            corner: differences(&values, &recording.segments(), CORNER)
                .into_iter()
                .fold(0.0, f64::max),
            flat: flat(&values, &moving),
            negative: below as f64 / count,
            frozen: frozen(recording, &moving, &values),
        })
    }
}

/// Step of the grid that all values are on; none where they are on no grid.
fn step(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let range = sorted[sorted.len() - 1] - sorted[0];
    let gaps: Vec<f64> = sorted
        .windows(2)
        .map(|w| w[1] - w[0])
        .filter(|g| *g > 1e-9 * range)
        .collect();
    // Numbers that hardly ever come again are on no grid.
    if gaps.len() < 2 || 2 * gaps.len() > values.len() {
        return None;
    }
    let smallest = quantile(gaps.clone(), 0.02)?;
    let near = gaps.iter().filter(|g| **g < 1.5 * smallest).copied();
    let step = median(near.collect())?;
    let whole = |g: &&f64| (*g / step - (*g / step).round()).abs() < OFF_GRID.max(1e-6);
    let on = gaps.iter().filter(whole).count() as f64;
    (on >= ON_GRID * gaps.len() as f64).then_some(step)
}

/// Standard deviation of white noise in some values, from the median of high-order differences; the smallest over
/// orders. Smooth signals, and the few samples around reversals, hardly change the median.
fn noise(values: &[f64], parts: &[Range<usize>]) -> f64 {
    let of = |order| median(differences(values, parts, order)).map(|m| m / 0.6745);
    ORDERS.filter_map(of).fold(f64::INFINITY, f64::min)
}

/// Magnitudes of the differences of an order, divided by the standard deviation that white noise of deviation 1 gives
/// them. Its square is the binomial coefficient (2k over k).
fn differences(values: &[f64], parts: &[Range<usize>], order: usize) -> Vec<f64> {
    let gain: f64 = (1..=order).map(|i| (order + i) as f64 / i as f64).product();
    let mut sizes = Vec::with_capacity(values.len());
    for part in parts {
        let mut d = values[part.clone()].to_vec();
        for _ in 0..order {
            d = d.windows(2).map(|w| w[1] - w[0]).collect();
        }
        sizes.extend(d.into_iter().map(|v| v.abs() / gain.sqrt()));
    }
    sizes
}

/// Whether the joint moves between each sample and the next of its trajectory.
fn moving(recording: &Recording, joint: usize) -> Vec<bool> {
    let (time, q) = (&recording.time, recording.q.column(joint));
    let mut speed = vec![0.0; recording.len()];
    for t in &recording.trajectories {
        for r in t.range.start..t.range.end - 1 {
            speed[r] = ((q[r + 1] - q[r]) / (time[r + 1] - time[r])).abs();
        }
    }
    let top = quantile(speed.clone(), 0.98).unwrap_or(0.0);
    let moves = moves(recording, joint);
    speed
        .into_iter()
        .map(|s| moves && s > MOVING * top)
        .collect()
}

/// Part of the samples in motion at a flat top of |τ|. At rest, any torque is flat.
fn flat(values: &[f64], moving: &[bool]) -> f64 {
    let both = values.iter().zip(moving);
    let own: Vec<f64> = both.filter(|(_, m)| **m).map(|(v, _)| *v).collect();
    if own.is_empty() {
        return 0.0;
    }
    plateau(&own).map_or(0.0, |(_, share)| share)
}

/// Longest run of one constant value during motion: as a part of the time in motion, and in seconds.
fn frozen(recording: &Recording, moving: &[bool], values: &[f64]) -> (f64, f64) {
    let (mut all, mut longest) = (0.0, 0.0_f64);
    for t in &recording.trajectories {
        let mut here = 0.0;
        for r in t.range.start..t.range.end - 1 {
            let step = if moving[r] {
                recording.time[r + 1] - recording.time[r]
            } else {
                0.0
            };
            here = if values[r] == values[r + 1] {
                here + step
            } else {
                0.0
            };
            all += step;
            longest = longest.max(here);
        }
    }
    (if all > 0.0 { longest / all } else { 0.0 }, longest)
}
