//! Conditions under which a candidate that was tried is accepted as a cause.

use super::select::{CandidateScore, Search};
use crate::algebra::fit::Fit;
use crate::catalogue::Candidate;
use crate::catalogue::effect::Effect;
use crate::settings::{Rule, SearchSettings};

impl Search<'_> {
    /// Whether a candidate that was tried on top of `fit` explains enough to be accepted. It must lower J by far. A
    /// smaller fall of J is enough where the removed error is visible on some joint, and large beside what parameters
    /// leave.
    pub(super) fn worth(&self, fit: &Fit, tried: &CandidateScore, others: &[usize]) -> bool {
        let s = self.objective.settings;
        let c = &self.candidates[tried.candidate];
        if self.by_trace(tried.candidate, others) {
            return tried.gain >= s.enough;
        }
        // Evidence of traces and other sensors ranks candidates; the candidate's own columns must still lower J by
        // enough.
        let gain = tried.gain - c.evidence;
        if gain < s.enough || (!c.effect.info().parameter && gain <= self.chance) {
            return false;
        }
        let before = self.objective.relative(&fit.error());
        let after = self.objective.relative(&tried.error);
        let removed: Vec<f64> = before
            .iter()
            .zip(&after)
            .map(|(b, a)| b * b - a * a)
            .collect();
        let visible = removed.iter().any(|r| *r > s.visible * s.visible);
        let misfit = removed.iter().sum::<f64>() > s.share * self.missing() && visible;
        let part = fraction(&before, &after, &c.joints);
        let enough = |least: f64| part >= least;
        let (own, usual) = (
            enough(self.least_fraction(c, others)),
            enough(c.effect.info().least_fraction),
        );
        let large = if s.off.applies(Rule::PartByEffect, own != usual) {
            own
        } else {
            usual
        };
        let own = (misfit && !c.effect.info().memory) || gain > self.clear(c, part);
        let usual = misfit || gain > s.enough_unseen * s.enough;
        let sure = if s.off.applies(Rule::GainByEffect, own != usual) {
            own
        } else {
            usual
        };
        large && sure
    }

    /// Fall of J, nats, from which a candidate that removes `part` of its joints' squared error needs no visible error. A
    /// wrong velocity sign at reversals looks like friction, but not like effects of load, gravity or inertia.
    fn clear(&self, candidate: &Candidate, part: f64) -> f64 {
        let s = self.objective.settings;
        let info = candidate.effect.info();
        s.enough
            * match candidate.effect {
                _ if info.memory && is_narrow(candidate, s) && part < s.plainly => s.enough_narrow,
                _ if info.memory => s.enough_memory,
                Effect::LoadDependentFriction => 1.0,
                _ if info.absorbable => 1.0,
                _ => s.enough_unseen,
            }
    }

    /// Whether a trace in the residual identifies a candidate without the criterion J. It does not where `others`, the
    /// accepted causes, have the same effect at another place: impacts of one joint shake its neighbours.
    pub(super) fn by_trace(&self, candidate: usize, others: &[usize]) -> bool {
        let c = &self.candidates[candidate];
        let same = |other: &usize| self.candidates[*other].effect == c.effect;
        c.shown.is_some() && !others.iter().any(same)
    }

    /// Least part of its joints' squared error that a candidate must remove. Effects that parameters can absorb have
    /// none, as without them the parameters would deviate instead. A wrong sign of the filtered velocity at reversals
    /// looks like memory over less than a milliradian, or like friction that falls off at once. These effects must
    /// remove a larger part.
    fn least_fraction(&self, candidate: &Candidate, others: &[usize]) -> f64 {
        let s = self.objective.settings;
        let abrupt = || {
            let shape = candidate.shape.first();
            shape.is_some_and(|shape| shape.value < s.abrupt)
        };
        let late = |c: &usize| self.candidates[*c].effect.info().late;
        match candidate.effect {
            Effect::StribeckFriction if abrupt() => s.plainly,
            effect if effect.info().memory && is_narrow(candidate, s) => s.narrow_part,
            // A delay of one joint alone, where no other has one, is more likely friction of another law, or a spring.
            effect if effect.info().late => {
                let alone = candidate.joints.len() == 1 && !others.iter().any(late);
                if alone { s.late_alone } else { s.late_part }
            }
            // No least part where another sensor has measured the effect.
            _ if !candidate.sizes.is_empty() => f64::NEG_INFINITY,
            // Elasticity must remove a larger part, as a spring explains some of any vibration.
            Effect::JointElasticity => s.plainly,
            effect => effect.info().least_fraction,
        }
    }

    /// Whether a candidate removes so large a part of its own joints' error that it cannot be a leftover of another
    /// cause.
    pub(super) fn plain(&self, fit: &Fit, tried: &CandidateScore) -> bool {
        let before = self.objective.relative(&fit.error());
        let after = self.objective.relative(&tried.error);
        let joints = &self.candidates[tried.candidate].joints;
        let s = self.objective.settings;
        fraction(&before, &after, joints) > s.plain_part && tried.gain > s.plain_gain
    }

    /// Gain, nats, that a further candidate must exceed beside the `accepted` causes with these `gains`. A large effect
    /// of another form leaves a residual that looks like a small effect. It looks most like the same effect on a
    /// neighbouring joint.
    pub(super) fn relative_price(
        &self,
        accepted: &[usize],
        gains: &[f64],
        candidate: usize,
    ) -> f64 {
        let s = self.objective.settings;
        let new = &self.candidates[candidate];
        let price = |(&a, &gain): (&usize, &f64)| {
            let earlier = &self.candidates[a];
            // Gain of a delay per joint, as it removes error and leaves a residual on every joint.
            let gain = if earlier.effect.info().late {
                gain / earlier.joints.len() as f64
            } else {
                gain
            };
            if earlier.effect.info().parameter {
                0.0
            } else if earlier.effect == new.effect {
                s.leftover_same * gain
            } else if earlier.touches(new) {
                s.leftover * gain
            } else {
                0.0
            }
        };
        accepted.iter().zip(gains).map(price).fold(0.0, f64::max)
    }
}

/// Part of the squared error of `joints` together that a candidate removes. `before` and `after` are RMS errors
/// relative to each joint's torque.
fn fraction(before: &[f64], after: &[f64], joints: &[usize]) -> f64 {
    let squares = |e: &[f64]| joints.iter().map(|&j| e[j] * e[j]).sum::<f64>();
    1.0 - squares(after) / squares(before).max(1e-300)
}

/// Whether the memory of a candidate's friction is over so short a displacement that a wrong velocity sign at reversals
/// imitates it.
fn is_narrow(candidate: &Candidate, settings: &SearchSettings) -> bool {
    let shape = candidate.shape.first();
    shape.is_some_and(|s| s.value < settings.narrow)
}
