//! Quadratic expansion of the likelihood about an arm in the parameters of all mechanisms, and decisions on it.

use super::free::Entry;
use crate::arm::Arm;
use crate::catalogue::{Effect, Mechanism};
use crate::fit::{Free, Noise, by_trajectory, local, sums};
use crate::given::Given;
use crate::parameter::Parameter;
use crate::simulate::{Track, Unstable};
use evidence::{Family, Hypothesis, Prior, Problem, Quadratic};

/// Prior odds that an effect acts anywhere on the arm: of the dozen effects in the catalogue, one is expected.
pub(super) const ODDS: f64 = 0.1;

/// Prior odds that a gain which the user states as exact is wrong: one typing error in a thousand.
pub(super) const STATED: f64 = 0.001;

/// Smallest time constant of a command filter about which the likelihood is expanded, s. At 0 it has no derivative.
pub(super) const LEAST_LAG: f64 = 5e-4;

/// Family of a mechanism: its effect, and whether it acts on one joint or on the whole arm.
pub(super) fn family(m: &Mechanism) -> (Effect, bool) {
    (m.effect, m.joint.is_some())
}

/// Families of the mechanisms, sorted, each once.
pub(super) fn kinds(mechanisms: &[Mechanism]) -> Vec<(Effect, bool)> {
    let mut out: Vec<(Effect, bool)> = mechanisms.iter().map(family).collect();
    out.sort_unstable();
    out.dedup();
    out
}

/// Families of the mechanisms with their prior odds, in the order of [`kinds`]. Gains stated as exact have odds of
/// their own, and their joints are independent.
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

/// One hypothesis for each mechanism with its family; the entries that it frees are left empty.
pub(super) fn hypotheses(mechanisms: &[Mechanism]) -> Vec<Hypothesis> {
    let kinds = kinds(mechanisms);
    let of = |m: &Mechanism| Hypothesis {
        parameters: Vec::new(),
        family: kinds.binary_search(&family(m)).expect("it is among them"),
    };
    mechanisms.iter().map(of).collect()
}

/// Comparison of `mechanisms` on an expansion of the likelihood about `arm`, with one hypothesis for each in their order. It
/// has the parameters of `always` and of those that `asked` marks; a physical parameter has an entry for each reason to
/// differ. `noises` is the noise model of each joint.
///
/// # Errors
/// Arm that is unstable.
pub(super) fn expand(
    given: &Given,
    mechanisms: &[Mechanism],
    asked: &[bool],
    always: &[Entry],
    arm: &Arm,
    blocks: &[Track],
    noises: &[Noise],
) -> Result<Problem, Unstable> {
    let mut arm = arm.clone();
    for servo in &mut arm.servos {
        servo.lag = servo.lag.max(LEAST_LAG);
    }
    let mut entries: Vec<Entry> = always.to_vec();
    let mut hypotheses = hypotheses(mechanisms);
    for ((m, own), asked) in mechanisms.iter().zip(&mut hypotheses).zip(asked) {
        if !asked {
            continue;
        }
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
    // Point of the expansion: of several entries for one parameter the first has the fitted value, and the others have
    // the given one.
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
    let always = (0..always.len()).collect();
    let families = families(given, mechanisms);
    Ok(Problem::new(
        quadratic, priors, always, hypotheses, families,
    ))
}
