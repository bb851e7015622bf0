//! Limits that are lower than given: a limit that is never met has no derivative.

use super::Search;
use super::expand::ODDS;
use super::visited::joined;
use crate::arm::Arm;
use crate::catalogue::Effect;
use crate::fit::{Noise, objective};
use crate::parameter::Parameter;
use crate::simulate::{Unstable, reached};

/// Parts of the largest torque that a drive reaches in the simulated motion which are tried as start of a fit of its limit. A limit
/// above that torque is never met.
const PARTS: [f64; 5] = [0.7, 0.5, 0.35, 0.25, 0.18];
/// Number of halvings of what lies between two of them: the limit is then within about a hundredth.
const HALVINGS: usize = 5;

impl Search<'_> {
    /// Limits, as mechanisms, that explain more than their prior odds cost where they are lower than in `about`, and the
    /// arm with them. `about` is a fit with the mechanisms `set`; joints follow one another.
    pub(super) fn cut(
        &self,
        about: &Arm,
        set: &[usize],
        noise: &[Noise],
    ) -> Result<(Vec<usize>, Arm), Unstable> {
        let mut out = Vec::new();
        let mut arm = about.clone();
        let limits = self.mechanisms.iter().enumerate();
        for (m, own) in
            limits.filter(|(m, m2)| m2.effect == Effect::EffortLimit && !set.contains(m))
        {
            let parameter = own.parameters[0].parameter;
            let free = self.free(&joined(set, &joined(&out, &[m])));
            let value = |arm: &Arm| objective(arm, &free, self.blocks(), noise);
            let least = value(&arm)?;
            let lowest = self.lowest(&arm, parameter, value);
            if let Some((_, lower)) = lowest.filter(|(v, _)| *v < least + ODDS.ln()) {
                out.push(m);
                arm = lower;
            }
        }
        Ok((out, arm))
    }

    /// Arm `base` with the limit of the lowest `value`, and that value, nats. The parts are tried first, and then what lies between
    /// the best one and its neighbours, as halving goes: where a drive reaches its limit the motion depends on it so much that
    /// derivatives lead nowhere. None where nothing can be simulated.
    fn lowest(
        &self,
        base: &Arm,
        limit: Parameter,
        value: impl Fn(&Arm) -> Result<f64, Unstable>,
    ) -> Option<(f64, Arm)> {
        let reached = reached(base, self.blocks(), limit.kind).ok()?[limit.joint];
        let at = |part: f64| {
            let mut trial = base.clone();
            trial.set(&[(limit, part * reached)]).ok()?;
            value(&trial).ok().map(|v| (v, part, trial))
        };
        let lower = |a: &(f64, f64, Arm), b: &(f64, f64, Arm)| a.0.total_cmp(&b.0);
        let parts = PARTS.into_iter().filter(|_| reached > 0.0);
        let mut best = parts.filter_map(at).min_by(lower)?;
        let mut ratio = PARTS[0] / PARTS[1];
        for _ in 0..HALVINGS {
            ratio = ratio.sqrt();
            let sides = [best.1 / ratio, best.1 * ratio].into_iter().filter_map(at);
            best = sides.chain([best.clone()]).min_by(lower)?;
        }
        Some((best.0, best.2))
    }
}
