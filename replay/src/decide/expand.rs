//! The likelihood about an arm in all parameters of the mechanisms, and what is decided on it.

use super::free::Entry;
use crate::arm::Arm;
use crate::catalogue::{self, Effect, Mechanism, Sizes};
use crate::fit::{Free, Noise, by_trajectory, local, sums};
use crate::given::Given;
use crate::parameter::Parameter;
use crate::simulate::{Track, Unstable};
use crate::tracks::Replayed;
use evidence::{Decision, Family, Hypothesis, Prior, Quadratic, decide};

/// Prior odds of an effect anywhere on the arm: of the dozen effects of the catalogue one is expected.
pub(super) const ODDS: f64 = 0.1;

/// Prior odds that a gain which the user states without tolerance is wrong: one typing error in a thousand.
pub(super) const STATED: f64 = 0.001;

/// Smallest lag with which a command filter can be differentiated, s.
pub(super) const LEAST_LAG: f64 = 5e-4;

/// Families of mechanisms: an effect, apart by whether it is of a joint or of the whole arm.
pub(super) fn family(m: &Mechanism) -> (Effect, bool) {
    (m.effect, m.joint.is_some())
}

pub(super) fn kinds(mechanisms: &[Mechanism]) -> Vec<(Effect, bool)> {
    let mut out: Vec<(Effect, bool)> = mechanisms.iter().map(family).collect();
    out.sort_unstable();
    out.dedup();
    out
}

pub(super) fn families(given: &Given, mechanisms: &[Mechanism]) -> Vec<Family> {
    let of = |kind: (Effect, bool)| {
        let places = mechanisms.iter().filter(|m| family(m) == kind).count();
        let stated = matches!(kind.0, Effect::ServoGain | Effect::ServoDamping) && given.stated;
        Family {
            odds: if stated { STATED } else { ODDS },
            places,
            independent: stated,
        }
    };
    kinds(mechanisms).into_iter().map(of).collect()
}

/// Expansion of the likelihood about an arm in all parameters of the mechanisms.
pub(super) struct Expanded {
    pub(super) quadratic: Quadratic,
    pub(super) priors: Vec<Prior>,
    pub(super) always: Vec<usize>,
    pub(super) hypotheses: Vec<Hypothesis>,
    pub(super) families: Vec<Family>,
}

impl Expanded {
    pub(super) fn decide(&self, start: &[usize]) -> Decision {
        decide(
            &self.quadratic,
            &self.priors,
            &self.always,
            &self.hypotheses,
            &self.families,
            start,
        )
    }

    pub(super) fn about(&self, set: &[usize]) -> Decision {
        evidence::about(
            &self.quadratic,
            &self.priors,
            &self.always,
            &self.hypotheses,
            &self.families,
            set,
        )
    }
}

/// Hypotheses with their families; what they free is numbered by whoever expands.
pub(super) fn hypotheses(mechanisms: &[Mechanism]) -> Vec<Hypothesis> {
    let kinds = kinds(mechanisms);
    let of = |m: &Mechanism| Hypothesis {
        parameters: Vec::new(),
        family: kinds.binary_search(&family(m)).expect("it is among them"),
    };
    mechanisms.iter().map(of).collect()
}

pub(super) fn expand(
    given: &Given,
    mechanisms: &[Mechanism],
    always: &[Entry],
    arm: &Arm,
    blocks: &[Track],
    noises: &[Noise],
) -> Result<Expanded, Unstable> {
    let mut arm = arm.clone();
    for servo in &mut arm.servos {
        servo.lag = servo.lag.max(LEAST_LAG);
    }
    let mut entries: Vec<Entry> = always.to_vec();
    let mut hypotheses = hypotheses(mechanisms);
    for (m, own) in mechanisms.iter().zip(&mut hypotheses) {
        own.parameters = (entries.len()..entries.len() + m.parameters.len()).collect();
        entries.extend(m.parameters.iter().map(|sized| Entry {
            parameter: sized.parameter,
            deviation: sized.deviation,
        }));
    }
    let mut unique: Vec<Parameter> = entries.iter().map(|e| e.parameter).collect();
    unique.sort_unstable();
    unique.dedup();
    let all: Vec<Free> = unique
        .iter()
        .map(|&parameter| Free {
            parameter,
            prior: None,
        })
        .collect();
    let x: Vec<f64> = all
        .iter()
        .map(|f| f.coordinate(arm.get(f.parameter)))
        .collect();
    let total = by_trajectory(&sums(&arm, blocks, &unique)?);
    let (gradient, information) = local(&total, noises, &all, &x);
    let place: Vec<usize> = entries
        .iter()
        .map(|e| {
            unique
                .binary_search(&e.parameter)
                .expect("it is among them")
        })
        .collect();
    let p = entries.len();
    // Of a number with several reasons the deviation at the fit belongs to the first; together they make it up.
    let mut seen = std::collections::HashSet::new();
    let at = place
        .iter()
        .map(|&k| {
            let mean = all[k].coordinate(given.arm.get(unique[k]));
            if seen.insert(k) { x[k] } else { mean }
        })
        .collect();
    let priors = entries
        .iter()
        .zip(&place)
        .map(|(e, &k)| Prior {
            mean: all[k].coordinate(given.arm.get(unique[k])),
            deviation: e.deviation,
            positive: e.parameter.kind.scale() == crate::parameter::Scale::Positive,
        })
        .collect();
    let quadratic = Quadratic {
        at,
        gradient: nalgebra::DVector::from_iterator(p, place.iter().map(|&k| gradient[k])),
        information: nalgebra::DMatrix::from_fn(p, p, |i, k| information[(place[i], place[k])]),
    };
    Ok(Expanded {
        quadratic,
        priors,
        always: (0..always.len()).collect(),
        hypotheses,
        families: families(given, mechanisms),
    })
}

/// Joints on which a smooth unknown torque is more probable than not, beside the set, with its probability.
#[allow(clippy::too_many_arguments)]
pub(super) fn beside(
    given: &Given,
    mechanisms: &[Mechanism],
    always: &[Entry],
    arm: &Arm,
    replayed: &Replayed,
    noises: &[Noise],
    set: &[usize],
    sizes: &Sizes,
) -> Result<Vec<(usize, f64)>, Unstable> {
    let mut with: Vec<Mechanism> = set.iter().map(|&m| mechanisms[m].clone()).collect();
    let start: Vec<usize> = (0..with.len()).collect();
    let moving: Vec<usize> = (0..arm.dof()).filter(|&j| replayed.moves[j]).collect();
    with.extend(moving.iter().map(|&j| catalogue::unknown(j, sizes)));
    let expanded = expand(given, &with, always, arm, &replayed.blocks, noises)?;
    let decision = expanded.decide(&start);
    let own = |k: usize| decision.inclusion[start.len() + k];
    Ok(moving
        .iter()
        .enumerate()
        .map(|(k, &j)| (j, own(k)))
        .filter(|(_, p)| *p >= 0.5)
        .collect())
}
