//! Sets that were fitted, and how probable each is at its own fit.

use crate::fit::{Fitted, Free, Noise, by_trajectory, evidence, likelihood, local, prior};
use crate::floor::SMALL;

/// Set of mechanisms that was fitted in the search.
#[derive(Clone)]
pub(super) struct Visited {
    /// Mechanisms of the set, indices increasing.
    pub(super) set: Vec<usize>,
    /// Free parameters of the fit, in the order of its coordinates.
    pub(super) free: Vec<Free>,
    /// Fit in which the mechanisms of the set are free.
    pub(super) fitted: Fitted,
}

impl Visited {
    /// Negative log likelihood of the fit, nats, up to a constant.
    pub(super) fn misfit(&self, noises: &[Noise]) -> f64 {
        likelihood(&by_trajectory(&self.fitted.blocks), noises)
    }

    /// Log evidence of the set, nats, up to a constant: Laplace approximation at the set's own fit.
    pub(super) fn log_evidence(&self, noises: &[Noise]) -> f64 {
        let total = by_trajectory(&self.fitted.blocks);
        let value = likelihood(&total, noises) + prior(&self.free, &self.fitted.x);
        let (_, mut precision) = local(&total, noises, &self.free, &self.fitted.x);
        for (i, f) in self.free.iter().enumerate() {
            precision[(i, i)] += f.prior.map_or(0.0, |(_, deviation)| deviation.powi(-2));
        }
        evidence(&self.free, value, &precision)
    }

    /// Whether every joint's RMS error is at most [`SMALL`] of its tracking error (`tracking`, rad).
    pub(super) fn explains(&self, tracking: &[f64]) -> bool {
        let samples: f64 = self.fitted.blocks.iter().map(|b| b.samples).sum();
        let least = |j: usize| self.fitted.blocks.iter().map(|b| b.squared[j]).sum::<f64>();
        (0..tracking.len()).all(|j| least(j) <= samples * (SMALL * tracking[j]).powi(2))
    }

    /// Index of the joint whose error is the largest part of its tracking error (`tracking`, rad).
    pub(super) fn least_explained(&self, tracking: &[f64]) -> usize {
        let squared = |j: usize| -> f64 {
            let all: f64 = self.fitted.blocks.iter().map(|b| b.squared[j]).sum();
            if tracking[j] > 0.0 {
                all / tracking[j].powi(2)
            } else {
                0.0
            }
        };
        let joints = 0..tracking.len();
        joints
            .max_by(|&a, &b| squared(a).total_cmp(&squared(b)))
            .unwrap_or(0)
    }
}

/// Index of the largest value.
pub(super) fn largest(values: &[f64]) -> usize {
    let all = 0..values.len();
    all.max_by(|&a, &b| values[a].total_cmp(&values[b]))
        .unwrap_or(0)
}

/// Union of two sets that share nothing, indices increasing.
pub(super) fn joined(set: &[usize], other: &[usize]) -> Vec<usize> {
    let mut out = [set, other].concat();
    out.sort_unstable();
    out
}
