//! What the recorded numbers themselves show, without any model.

use datasets::Recording;
use datasets::check::{moves, plateau};
use signal::quantile::{median, quantile};
use std::ops::Range;

/// Orders of the differences from which the noise is estimated: the higher, the less of the motion passes.
const ORDERS: Range<usize> = 3..8;
/// Order of the differences that show a corner.
const CORNER: usize = 6;
/// Part of the gaps between neighbouring numbers that must be a whole number of steps for a grid …
const ON_GRID: f64 = 0.97;
/// … and the part of a step up to which a gap counts as a whole number of steps.
const OFF_GRID: f64 = 0.02;
/// Speed above which a joint moves, as a part of its largest speed.
const MOVING: f64 = 0.05;

/// The numbers of one joint's torque.
#[derive(Clone, Debug)]
pub(super) struct Numbers {
    /// Root mean square of the torque about its mean, in the recorded unit.
    pub spread: f64,
    /// Largest absolute value of the torque, in the recorded unit.
    pub largest: f64,
    /// Step of the grid that they lie on, where they lie on one.
    pub step: Option<f64>,
    /// Standard deviation of the torque's noise: of what a smooth signal does not have.
    pub noise: f64,
    /// Largest difference of high order, on the scale of the deviation `noise`: sharpness of the sharpest corner.
    pub corner: f64,
    /// Part of the samples at a flat top of |τ|, where there is one.
    pub flat: f64,
    /// Part of the samples that is below zero by more than a hundredth of the largest.
    pub negative: f64,
    /// Longest part of the time in motion in which one value stands, and its seconds.
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

/// Step of a grid that all values lie on.
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

/// Deviation of white noise by differences of high order, the least over orders: what is smooth, and the few samples
/// around a reversal, hardly count in their median.
fn noise(values: &[f64], parts: &[Range<usize>]) -> f64 {
    let of = |order| median(differences(values, parts, order)).map(|m| m / 0.6745);
    ORDERS.filter_map(of).fold(f64::INFINITY, f64::min)
}

/// Sizes of the differences of some order over the deviation that white noise of deviation 1 gives them: the binomial
/// coefficient (2k over k) is its square.
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

/// Part of the samples in motion on a flat top of |τ|: at rest any torque is flat.
fn flat(values: &[f64], moving: &[bool]) -> f64 {
    let both = values.iter().zip(moving);
    let own: Vec<f64> = both.filter(|(_, m)| **m).map(|(v, _)| *v).collect();
    if own.is_empty() {
        return 0.0;
    }
    plateau(&own).map_or(0.0, |(_, share)| share)
}

/// The longest stretch of time in motion with one value, over all such time, and its seconds.
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
