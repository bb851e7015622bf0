//! Errors of a roll-out: one uninterrupted simulation over each trajectory, from its recorded start.

use crate::arm::Arm;
use crate::fit::errors;
use crate::simulate::{Track, Unstable};
use crate::tracks::Replayed;
use model::spread::NINETY;
use rayon::prelude::*;
use serde::Serialize;

/// Simulated less recorded positions of a roll-out, rad (m). For each trajectory: samples × joints, row by row.
pub type Errors = Vec<Vec<f64>>;

/// Errors of one simulator over all trajectories, by joint. A joint that never moves, or has no tracking error, has
/// none (null).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figures {
    /// RMS of simulated less recorded position, rad (m).
    pub rmse: Vec<Option<f64>>,
    /// RMS of command less recorded position, rad (m).
    pub tracking: Vec<Option<f64>>,
    /// Ratio `rmse / tracking`: 0 for a perfect simulator, 1 for one that only repeats the commands.
    pub unexplained: Vec<Option<f64>>,
    /// Mean of `unexplained` over the joints that have one; none where no joint has.
    pub mean_unexplained: Option<f64>,
}

/// Errors of a roll-out of every whole trajectory.
///
/// # Errors
/// Drive that is unstable.
pub fn roll_out(arm: &Arm, replayed: &Replayed) -> Result<Errors, Unstable> {
    replayed
        .whole
        .par_iter()
        .map(|track: &Track| errors(arm, track))
        .collect()
}

/// Errors of a roll-out as figures by joint.
pub fn figures(all: &Errors, replayed: &Replayed) -> Figures {
    let n = replayed.tracking.len();
    let samples: usize = all.iter().map(|e| e.len() / n).sum();
    let rmse: Vec<f64> = by_joint(all, n)
        .iter()
        .map(|squared| (squared / samples as f64).sqrt())
        .collect();
    of_rmse(&rmse, replayed)
}

/// Figures of an RMS error of each joint, rad (m).
pub fn of_rmse(rmse: &[f64], replayed: &Replayed) -> Figures {
    let n = replayed.tracking.len();
    let kept = |j: usize| replayed.moves[j] && replayed.tracking[j] > 0.0;
    let some = |j: usize, v: f64| kept(j).then_some(v);
    let unexplained: Vec<Option<f64>> = (0..n)
        .map(|j| some(j, rmse[j] / replayed.tracking[j]))
        .collect();
    let count = unexplained.iter().flatten().count();
    Figures {
        rmse: (0..n).map(|j| some(j, rmse[j])).collect(),
        tracking: (0..n).map(|j| some(j, replayed.tracking[j])).collect(),
        mean_unexplained: (count > 0)
            .then(|| unexplained.iter().flatten().sum::<f64>() / count as f64),
        unexplained,
    }
}

/// Sum of squared errors of each of `n` joints, over all trajectories.
pub fn by_joint(all: &Errors, n: usize) -> Vec<f64> {
    let mut squared = vec![0.0; n];
    for e in all {
        for (i, v) in e.iter().enumerate() {
            squared[i % n] += v * v;
        }
    }
    squared
}

/// Length of a stretch, s, over which squared errors are summed for a confidence interval. It is longer than the
/// errors' autocorrelation.
const STRETCH: f64 = 5.0;
/// Least number of stretches that a trajectory is divided into, however short it is.
const FEWEST: usize = 4;

/// Sum of squared errors of the listed joints over each stretch of about five seconds.
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

/// Part of the squared error that is removed, (before − after)/before, with its 90 % confidence interval. `before` and
/// `after` hold squared errors of the same stretches. The interval is a jackknife over stretches with a normal
/// distribution.
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
    let half = NINETY * variance.sqrt();
    (whole, [whole - half, whole + half])
}
