//! Delay of the recorded torque after the motion: a first guess for all joints, and their common delay.

use super::fit::Moments;
use super::systems::Systems;
use datasets::channel::Estimate95;
use rayon::prelude::*;
use signal::delay::{Search, profile, student_975};

/// Least gain in log-likelihood of a delay over none, nats: by chance one recording in twenty reaches it.
const NOT_NOISE: f64 = 3.0;
/// Number of independent rows as a part of all rows, which the low-pass correlates.
const OWN: f64 = 0.3;

/// First guess of the common delay, s: the one with the least Σ log of squared errors over all joints, each joint's
/// model fitted freely. It is 0 where chance could give as small an error, given the number of delays tried.
pub(super) fn guess(systems: &Systems) -> f64 {
    let search = Search::default();
    let each: Vec<Vec<(f64, f64)>> = systems
        .joints
        .par_iter()
        .enumerate()
        .filter_map(|(j, joint)| profile(&systems.system(joint.as_ref()?, j), &search))
        .collect();
    let Some(first) = each.first() else {
        return 0.0;
    };
    let sum = |k: usize| -> f64 {
        each.iter()
            .map(|p| p[k].1.max(f64::MIN_POSITIVE).ln())
            .sum()
    };
    let all = 0..first.len();
    let best = all.clone().min_by(|&a, &b| sum(a).total_cmp(&sum(b)));
    let none = all.min_by(|&a, &b| first[a].0.abs().total_cmp(&first[b].0.abs()));
    let rows: usize = systems
        .segments
        .iter()
        .map(std::iter::ExactSizeIterator::len)
        .sum();
    best.zip(none).map_or(0.0, |(best, none)| {
        let gain = 0.5 * OWN * rows as f64 * (sum(none) - sum(best));
        if gain > NOT_NOISE + (first.len() as f64).ln() {
            first[best].0
        } else {
            0.0
        }
    })
}

/// Mean of a value over the joints, and the variance of that value between joints.
pub(super) struct Common {
    /// Mean over the joints; NaN where no joint's value is known.
    pub mean: f64,
    /// Half width of the mean's 95 % interval.
    half: f64,
    /// Variance between the joints beyond their own variances.
    pub between: f64,
}

impl Common {
    /// Mean with its 95 % interval, widened by a systematic error of about `apart`.
    pub fn estimate(&self, apart: f64) -> Estimate95 {
        let half = self.half.hypot(apart);
        Estimate95::new(self.mean, [self.mean - half, self.mean + half])
    }
}

/// Mean over the joints, weighted by precision, with the variance between joints beyond their own variances
/// (DerSimonian and Laird 1986). The interval follows from the joints' differences (Hartung and Knapp 2001). That
/// variance holds model errors that differ from joint to joint.
pub(super) fn common(joints: &[Moments], blocks: usize) -> Common {
    let known: Vec<(f64, f64)> = joints
        .iter()
        .map(|d| (d.value, d.variance.max(1e-10)))
        .collect();
    let sum = |f: &dyn Fn(&(f64, f64)) -> f64| known.iter().map(f).sum::<f64>();
    let n = known.len();
    let degrees = match n {
        0 => {
            return Common {
                mean: f64::NAN,
                half: f64::NAN,
                between: 0.0,
            };
        }
        1 => blocks.saturating_sub(1),
        _ => n - 1,
    };
    let w = sum(&|(_, v)| 1.0 / v);
    let mean = sum(&|(d, v)| d / v) / w;
    let q = sum(&|(d, v)| (d - mean).powi(2) / v);
    let own = w - sum(&|(_, v)| v.powi(-2)) / w;
    let between = if n > 1 {
        ((q - (n - 1) as f64) / own).max(0.0)
    } else {
        0.0
    };
    let w = sum(&|(_, v)| 1.0 / (v + between));
    let mean = sum(&|(d, v)| d / (v + between)) / w;
    let spread = sum(&|(d, v)| (d - mean).powi(2) / (v + between)) / degrees.max(1) as f64;
    // Joints that agree better than their deviations allow do not make them smaller.
    let half = student_975(degrees) * (spread.max(1.0) / w).sqrt();
    Common {
        mean,
        half,
        between,
    }
}
