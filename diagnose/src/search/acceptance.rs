//! Conditions under which a candidate that was tried is accepted as a cause.

use super::select::{CandidateScore, Search};
use crate::algebra::fit::Fit;
use crate::catalogue::Candidate;
use crate::catalogue::effect::Effect;
use crate::settings::{Rule, SearchSettings};
use signal::quantile::median;

/// Special rules on the acceptance of one trial.
const RULES: [Rule; 4] = [
    Rule::GainByEffect,
    Rule::PartByEffect,
    Rule::MiddleJoint,
    Rule::LargeGain,
];

/// Improvement that a candidate makes when it is added to a fit.
struct Removed {
    /// Fall of the criterion J by the candidate's own columns, nats, without evidence from a trace or another sensor.
    gain: f64,
    /// Whether the removed error is visible on some joint, and large beside the error that parameters alone leave.
    misfit: bool,
    /// Part of the squared error of the candidate's joints that it removes, all of these joints together; see
    /// [`fraction`].
    whole: f64,
    /// Part of the squared error that a delay removes, by [`late_fraction`]: on the median joint where that is more.
    late: f64,
}

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
        let trial = Removed {
            gain,
            misfit: removed.iter().sum::<f64>() > s.share * self.missing() && visible,
            whole: fraction(&before, &after, &c.joints),
            late: late_fraction(&before, &after, &c.joints),
        };
        let on = |rules: usize| {
            let on = |k: usize| rules & 1 << k != 0 && !s.off.holds(RULES[k]);
            std::array::from_fn(on)
        };
        let passes = |rules: usize| self.passes(c, &trial, others, on(rules));
        // A rule decides where it matters beside any choice of the others, so that an ablation may also switch off several.
        for (k, rule) in RULES.into_iter().enumerate() {
            let mut beside = (0..1 << RULES.len()).filter(|rules| rules & 1 << k == 0);
            let differ = beside.any(|rules| passes(rules) != passes(rules | 1 << k));
            s.off.applies(rule, differ);
        }
        passes((1 << RULES.len()) - 1)
    }

    /// Whether a trial is accepted under the special rules that are `on`, in the order of [`RULES`].
    fn passes(&self, c: &Candidate, trial: &Removed, others: &[usize], on: [bool; 4]) -> bool {
        let s = self.objective.settings;
        let [by_effect, part_by_effect, middle, large] = on;
        let memory = by_effect && c.effect.info().memory;
        let part = if c.effect.info().late && middle {
            trial.late
        } else {
            trial.whole
        };
        let sure = large && c.effect.info().dynamic && trial.gain > s.enough_dynamic * s.enough;
        let least = if part_by_effect {
            self.least_fraction(c, others)
        } else {
            c.effect.info().least_fraction
        };
        if part < least && !sure {
            return false;
        }
        // Required gain by effect: a wrong velocity sign at reversals looks like friction, but not like effects of
        // load, gravity or inertia.
        let clear = match c.effect {
            _ if !by_effect => s.enough_unseen * s.enough,
            effect if effect.info().memory && is_narrow(c, s) && part < s.plainly => {
                s.enough_narrow * s.enough
            }
            effect if effect.info().memory => s.enough_memory * s.enough,
            Effect::LoadDependentFriction => s.enough,
            effect if effect.info().absorbable => s.enough,
            _ => s.enough_unseen * s.enough,
        };
        (trial.misfit && !memory) || trial.gain > clear
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

/// Part of the squared error that a delay of several joints removes: of all joints together, or on the median joint
/// where that is more. One joint with a large error of another cause would hide the delay in the sum.
fn late_fraction(before: &[f64], after: &[f64], joints: &[usize]) -> f64 {
    let own = |&j: &usize| fraction(before, after, &[j]);
    let middle = median(joints.iter().map(own).collect()).unwrap_or(0.0);
    fraction(before, after, joints).max(middle)
}

/// Whether the memory of a candidate's friction is over so short a displacement that a wrong velocity sign at reversals
/// imitates it.
fn is_narrow(candidate: &Candidate, settings: &SearchSettings) -> bool {
    let shape = candidate.shape.first();
    shape.is_some_and(|s| s.value < settings.narrow)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_joint_that_errs_for_another_reason_does_not_hide_a_delay_of_all() {
        let late = |after: &[f64]| late_fraction(&[0.1, 0.1, 1.0], after, &[0, 1, 2]);
        assert!(late(&[0.07, 0.07, 0.99]) > 0.4);
        // What one joint lacks is no delay of all.
        assert!(late(&[0.1, 0.1, 0.95]) < 0.1);
        assert!(late(&[0.02, 0.1, 0.99]) < 0.1);
        // A single joint is asked for its own error.
        assert_eq!(late_fraction(&[1.0], &[0.5], &[0]), 0.75);
    }
}
