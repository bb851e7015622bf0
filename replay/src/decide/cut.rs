//! Limits that are lower than given: a limit that is never met has no derivative.

use super::Search;
use super::effort::CUT;
use super::expand::ODDS;
use crate::arm::Arm;
use crate::catalogue::Effect;
use crate::fit::{Free, Noise, descend, objective};
use crate::simulate::Unstable;

/// Parts of the given limit that are tried as start of a fit of a lower one.
const PARTS: [f64; 5] = [0.7, 0.5, 0.35, 0.25, 0.18];

impl Search<'_> {
    /// Limits, as mechanisms, that explain more than their prior odds cost where they are lower than in `about`, and the
    /// arm with them. `about` is a fit with the mechanisms `set`; joints follow one another.
    pub(super) fn cut(
        &self,
        about: &Arm,
        set: &[usize],
        noise: &[Noise],
    ) -> Result<(Vec<usize>, Arm), Unstable> {
        let blocks = self.blocks();
        let mut out = Vec::new();
        let mut arm = about.clone();
        let limits = self.mechanisms.iter().enumerate();
        for (m, own) in
            limits.filter(|(m, m2)| m2.effect == Effect::EffortLimit && !set.contains(m))
        {
            let parameter = own.parameters[0].parameter;
            let free = self.free(&joined(set, &joined(&out, &[m])));
            let value = |arm: &Arm| objective(arm, &free, blocks, noise);
            let alone: Vec<Free> = free
                .iter()
                .copied()
                .filter(|f| f.parameter == parameter)
                .collect();
            let least = value(&arm)?;
            let whole = self.given.arm.get(parameter);
            let mut tried: Vec<(f64, Arm)> = Vec::new();
            for part in PARTS {
                let mut trial = arm.clone();
                if trial.set(&[(parameter, part * whole)]).is_ok() {
                    tried.extend(value(&trial).ok().map(|v| (v, trial)));
                }
            }
            let Some((_, start)) = tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)) else {
                continue;
            };
            let lower = descend(&start, &alone, blocks, noise, CUT, None)?.arm;
            if value(&lower)? < least + ODDS.ln() {
                out.push(m);
                arm = lower;
            }
        }
        Ok((out, arm))
    }
}

/// Union of two sets that share nothing, indices increasing.
pub(super) fn joined(set: &[usize], other: &[usize]) -> Vec<usize> {
    let mut out = [set, other].concat();
    out.sort_unstable();
    out
}
