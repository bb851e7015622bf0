//! Delay of the recorded torque behind the motion: a first guess for all joints, and what they have in common.

use super::fit::Moments;
use super::systems::Systems;
use datasets::channel::Estimate95;
use rayon::prelude::*;
use signal::delay::{Search, profile, student_975};

/// Nats by which a delay has to explain a torque better than none before it is looked at: one in twenty is left …
const NOT_NOISE: f64 = 3.0;
/// … of rows that know something of their own: their low-pass lets this part of them through.
const OWN: f64 = 0.3;

/// The delay at which all joints' own models, fitted freely, leave least: Σ log of the squared errors. None where as small an error would
/// come of noise, by the number of delays that are tried: a fit that starts there would never come back.
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

/// What the joints have in common, with the variance between them.
pub(super) struct Common {
    /// Mean; not a number where nothing is known.
    pub mean: f64,
    /// Half width of its interval of 95 %.
    half: f64,
    /// Variance between the joints that their own variances do not explain.
    pub between: f64,
}

impl Common {
    /// Mean and interval, with a systematic error of about `apart` beside the scatter.
    pub fn estimate(&self, apart: f64) -> Estimate95 {
        let half = self.half.hypot(apart);
        Estimate95::new(self.mean, [self.mean - half, self.mean + half])
    }
}

/// The joints' mean weighted by precision, with the spread between them that their own deviations do not explain
/// (DerSimonian and Laird 1986) and an interval from how they differ (Hartung and Knapp 2001). A model that is wrong
/// differently on each joint shows in that spread.
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
