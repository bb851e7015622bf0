//! Figures of a replay: one uninterrupted roll-out over each trajectory, from its recorded start.

use crate::arm::Arm;
use crate::fit::errors;
use crate::simulate::{Track, Unstable};
use crate::tracks::Replayed;
use rayon::prelude::*;
use serde::Serialize;

/// Errors of a roll-out by trajectory: samples × joints, row by row.
pub type Errors = Vec<Vec<f64>>;

/// Figures of one step of the ladder; null for a joint that never moves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figures {
    /// RMS(q_sim − q), rad (m).
    pub rmse: Vec<Option<f64>>,
    /// RMS(q_ref − q), rad (m).
    pub tracking: Vec<Option<f64>>,
    /// `rmse / tracking`.
    pub unexplained: Vec<Option<f64>>,
    /// Mean over joints.
    pub mean_unexplained: Option<f64>,
}

/// Rolls out every trajectory.
///
/// # Errors
/// A drive that is unstable.
pub fn roll_out(arm: &Arm, replayed: &Replayed) -> Result<Errors, Unstable> {
    replayed
        .whole
        .par_iter()
        .map(|track: &Track| errors(arm, track))
        .collect()
}

/// Figures of a roll-out.
pub fn figures(all: &Errors, replayed: &Replayed) -> Figures {
    let n = replayed.tracking.len();
    let samples: usize = all.iter().map(|e| e.len() / n).sum();
    let squared = by_joint(all, n);
    let kept = |j: usize| replayed.moves[j] && replayed.tracking[j] > 0.0;
    let some = |j: usize, v: f64| kept(j).then_some(v);
    let rmse = |j: usize| (squared[j] / samples as f64).sqrt();
    let unexplained: Vec<Option<f64>> = (0..n)
        .map(|j| some(j, rmse(j) / replayed.tracking[j]))
        .collect();
    let count = unexplained.iter().flatten().count();
    Figures {
        rmse: (0..n).map(|j| some(j, rmse(j))).collect(),
        tracking: (0..n).map(|j| some(j, replayed.tracking[j])).collect(),
        mean_unexplained: (count > 0)
            .then(|| unexplained.iter().flatten().sum::<f64>() / count as f64),
        unexplained,
    }
}

/// Sum of squared errors by joint.
pub fn by_joint(all: &Errors, n: usize) -> Vec<f64> {
    let mut squared = vec![0.0; n];
    for e in all {
        for (i, v) in e.iter().enumerate() {
            squared[i % n] += v * v;
        }
    }
    squared
}

/// Length of a stretch over which errors are taken together for an interval, s: longer than they remember; and how many
/// stretches a short trajectory is dealt into all the same.
const STRETCH: f64 = 5.0;
const FEWEST: usize = 4;

/// Squared errors of some joints by stretch of a few seconds.
pub fn by_stretch(all: &Errors, replayed: &Replayed, joints: &[usize]) -> Vec<f64> {
    let n = replayed.tracking.len();
    let mut out = Vec::new();
    for (e, track) in all.iter().zip(&replayed.whole) {
        let span = track.time[track.time.len() - 1] - track.time[0];
        let count = ((span / STRETCH) as usize).max(FEWEST);
        let rows = track.time.len();
        for b in 0..count {
            let part = rows * b / count..rows * (b + 1) / count;
            let sum = part
                .flat_map(|r| joints.iter().map(move |&j| e[r * n + j].powi(2)))
                .sum();
            out.push(sum);
        }
    }
    out
}

/// Part of the squared error that is removed, (before − after)/before, with its 90 % interval by stretches left out
/// (jackknife; the interval is that of a normal distribution).
pub fn closed(before: &[f64], after: &[f64]) -> (f64, [f64; 2]) {
    let part = |b: f64, a: f64| if b > 0.0 { (b - a) / b } else { 0.0 };
    let (b, a): (f64, f64) = (before.iter().sum(), after.iter().sum());
    let whole = part(b, a);
    let m = before.len() as f64;
    let each: Vec<f64> = before
        .iter()
        .zip(after)
        .map(|(x, y)| part(b - x, a - y))
        .collect();
    let mean = each.iter().sum::<f64>() / m;
    let variance = each.iter().map(|v| (v - mean).powi(2)).sum::<f64>() * (m - 1.0) / m;
    let half = 1.645 * variance.sqrt();
    (whole, [whole - half, whole + half])
}
