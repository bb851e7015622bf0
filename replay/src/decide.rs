//! Which effects the motion shows: fits, expansion about them, and the decision by evidence.

use crate::arm::Arm;
use crate::catalogue::{self, Effect, Mechanism, Sizes};
use crate::fit::{self, Fitted, Free, Noise, by_trajectory, fit, local, noise, sums};
use crate::given::Given;
use crate::parameter::{Kind, Parameter};
use crate::simulate::{STEP, Track, Unstable};
use crate::tracks::Replayed;
use evidence::{Decision, Family, Hypothesis, Prior, Quadratic, decide};
use std::collections::BTreeMap;

/// Prior odds of an effect anywhere on the arm: of the dozen effects of the catalogue one is expected.
const ODDS: f64 = 0.1;

/// Prior odds that a gain which the user states without tolerance is wrong: one typing error in a thousand.
const STATED: f64 = 0.001;

/// Iterations of the first fit from the given values, and of fits from a neighbouring set.
const FIRST: usize = 25;
const NEXT: usize = 10;

/// Rounds of fit and decision; the set is stable after three in most cases.
const ROUNDS: usize = 5;

/// Smallest lag with which a command filter can be differentiated, s.
const LEAST_LAG: f64 = 5e-4;

/// A parameter as the decision sees it: several entries may be the same physical number with different reasons to differ.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Which.
    pub parameter: Parameter,
    /// Deviation of its coordinate for this reason.
    pub deviation: f64,
}

/// The state of a diagnosis: what is free under the causes found.
#[derive(Debug, Clone)]
pub struct Found {
    /// Mechanisms that were compared.
    pub mechanisms: Vec<Mechanism>,
    /// Those that are listed, with their inclusion probabilities.
    pub decision: Decision,
    /// Fit with the listed mechanisms.
    pub fitted: Fitted,
    /// Its free parameters.
    pub free: Vec<Free>,
    /// Joints on which something unknown is more probable than not, beside the listed mechanisms.
    pub unknown: Vec<(usize, f64)>,
}

/// Relative uncertainty of what any simulator's values mean: the description's masses, to which all torques are scaled, are
/// known to some per cent, and so is what an integrator makes of a gain.
pub const RELATIVE: f64 = 0.03;

/// Part of Coulomb friction by which two simulators' laws of friction at standstill differ (a soft constraint creeps).
const STANDSTILL: f64 = 0.1;

/// Parameters that are free under every hypothesis, with their deviations.
fn always(given: &Given, sizes: &Sizes) -> Vec<Entry> {
    let mut out = Vec::new();
    let mut add = |kind: Kind, joint: usize, deviation: f64| {
        if deviation > 0.0 && deviation.is_finite() {
            out.push(Entry {
                parameter: Parameter::new(kind, joint),
                deviation,
            });
        }
    };
    for (j, joint) in given.arm.joints.iter().enumerate() {
        add(Kind::Gain, j, RELATIVE);
        add(Kind::LinkScale, j, RELATIVE);
        add(Kind::ServoDamping, j, RELATIVE * given.arm.servos[j].kd);
        add(Kind::Damping, j, RELATIVE * joint.damping);
        add(Kind::Coulomb, j, RELATIVE * joint.coulomb);
        add(Kind::Stribeck, j, STANDSTILL * joint.coulomb);
        add(Kind::Armature, j, RELATIVE * joint.armature);
    }
    // Two integrators place a force within a step of their own.
    add(Kind::CommonDelay, 0, STEP);
    for &(parameter, t) in given.tolerances.iter().filter(|(_, t)| *t > 0.0) {
        let log = parameter.kind.scale() == crate::parameter::Scale::Log;
        let value = given.arm.get(parameter);
        add(
            parameter.kind,
            parameter.joint,
            if log { t } else { t * value.abs() },
        );
    }
    for &parameter in &given.free {
        add(
            parameter.kind,
            parameter.joint,
            3.0 * spread(parameter, sizes),
        );
    }
    out
}

/// Size of a parameter of which only its nature is known.
fn spread(parameter: Parameter, sizes: &Sizes) -> f64 {
    let (torque, j) = (sizes.torque[parameter.joint], parameter.joint);
    match parameter.kind {
        Kind::Gain | Kind::DriveLimit | Kind::Limit | Kind::Acceleration => 1.0,
        Kind::ServoDamping | Kind::Damping => torque / sizes.speed[j],
        Kind::Delay | Kind::CommonDelay | Kind::Lag => (2.0 * sizes.period).max(0.02),
        Kind::Armature => sizes.inertia[j],
        Kind::GravityCompensation => 0.5,
        Kind::Integral => torque,
        _ => torque,
    }
}

/// Finds the effects that explain the motion of `replayed`.
///
/// # Errors
/// The simulator as given is unstable.
pub fn find(
    given: &Given,
    replayed: &Replayed,
    mut stage: impl FnMut(&str),
) -> Result<Found, Unstable> {
    let sizes = Sizes::of(given, replayed);
    let mechanisms = catalogue::mechanisms(given, replayed, &sizes);
    let always = always(given, &sizes);
    let blocks = &replayed.blocks;
    let floors: Vec<f64> = replayed
        .quantum
        .iter()
        .map(|q| (q * q / 12.0).max(1e-14))
        .collect();
    stage("fitting drives and joints");
    let mut set: Vec<usize> = (0..mechanisms.len())
        .filter(|&m| is_core(&mechanisms[m]))
        .collect();
    let first: Vec<Noise> = floors
        .iter()
        .map(|&floor| Noise {
            floor,
            // A quarter of a second, until the fit shows its own.
            correlation: (0.25 / sizes.period).max(1.0),
        })
        .collect();
    let free = free(given, &mechanisms, &set, &always);
    let mut fitted = fit(&given.arm, &free, blocks, &first, FIRST)?;
    let mut noises = noise(&fitted.arm, blocks, &floors)?;
    let mut listed = free;
    let mut decision = None;
    for round in 0..ROUNDS {
        stage("weighing causes");
        let next = weigh(
            given,
            &mechanisms,
            &always,
            &fitted.arm,
            blocks,
            &noises,
            &set,
        )?;
        let stable = next.set == set && round > 0;
        set.clone_from(&next.set);
        decision = Some(next);
        if stable {
            break;
        }
        stage("fitting with the causes found");
        listed = self::free(given, &mechanisms, &set, &always);
        let start = pinned(given, &fitted.arm, &listed);
        fitted = fit(&start, &listed, blocks, &noises, NEXT)?;
        noises = noise(&fitted.arm, blocks, &floors)?;
    }
    // What the fit leaves at nothing is no cause.
    if let Some(decision) = &mut decision {
        let acts = |m: usize| {
            mechanisms[m]
                .parameters
                .iter()
                .any(|s| fitted.arm.get(s.parameter) != given.arm.get(s.parameter))
        };
        let kept: Vec<bool> = decision.set.iter().map(|&m| acts(m)).collect();
        let mut keep = kept.iter();
        decision.swaps.retain(|_| *keep.next().unwrap_or(&true));
        let mut keep = kept.iter();
        decision.set.retain(|_| *keep.next().unwrap_or(&true));
        set.clone_from(&decision.set);
    }
    stage("looking for something unknown");
    let unknown = beside(
        given,
        &mechanisms,
        &always,
        &fitted.arm,
        replayed,
        &noises,
        &set,
        &sizes,
    )?;
    Ok(Found {
        mechanisms,
        decision: decision.expect("at least one round"),
        fitted,
        free: listed,
        unknown,
    })
}

/// What the first fit frees: a drive and a joint as every servo has them.
fn is_core(m: &Mechanism) -> bool {
    let lag = m.effect == Effect::CommandDelay && m.joint.is_some();
    let core = [
        Effect::ServoGain,
        Effect::FrictionParameters,
        Effect::RotorInertia,
        Effect::CommandDelay,
        Effect::EncoderOffset,
    ];
    core.contains(&m.effect) && !lag
}

/// Free parameters of a fit: those of the set and those free under every one, each with the sum of its variances.
pub fn free(given: &Given, mechanisms: &[Mechanism], set: &[usize], always: &[Entry]) -> Vec<Free> {
    let mut variance: BTreeMap<Parameter, f64> = BTreeMap::new();
    let listed = set.iter().flat_map(|&m| &mechanisms[m].parameters);
    for entry in listed {
        *variance.entry(entry.parameter).or_default() += entry.deviation.powi(2);
    }
    for entry in always {
        *variance.entry(entry.parameter).or_default() += entry.deviation.powi(2);
    }
    variance
        .into_iter()
        .map(|(parameter, v)| {
            let mut own = Free {
                parameter,
                prior: None,
            };
            own.prior = Some((own.coordinate(given.arm.get(parameter)), v.sqrt()));
            own
        })
        .collect()
}

/// Free parameters that a tolerance or a missing value leaves open.
pub fn tolerated(given: &Given, replayed: &Replayed) -> Vec<Entry> {
    always(given, &Sizes::of(given, replayed))
}

/// The given arm with the fitted values of what is free.
pub fn pinned(given: &Given, fitted: &Arm, free: &[Free]) -> Arm {
    let mut arm = given.arm.clone();
    let values: Vec<(Parameter, f64)> = free
        .iter()
        .map(|f| (f.parameter, fitted.get(f.parameter)))
        .collect();
    // What was simulated once can be put together again.
    if arm.set(&values).is_err() {
        return fitted.clone();
    }
    arm
}

/// Expansion of the likelihood about `arm` in all parameters of the mechanisms, and the decision on it.
fn weigh(
    given: &Given,
    mechanisms: &[Mechanism],
    always: &[Entry],
    arm: &Arm,
    blocks: &[Track],
    noises: &[Noise],
    start: &[usize],
) -> Result<Decision, Unstable> {
    let (quadratic, priors, first, hypotheses) =
        expand(given, mechanisms, always, arm, blocks, noises)?;
    let families = families(given, mechanisms);
    Ok(decide(
        &quadratic,
        &priors,
        &first,
        &hypotheses,
        &families,
        start,
    ))
}

/// Families of mechanisms: an effect, apart by whether it is of a joint or of the whole arm.
fn family(m: &Mechanism) -> (Effect, bool) {
    (m.effect, m.joint.is_some())
}

fn kinds(mechanisms: &[Mechanism]) -> Vec<(Effect, bool)> {
    let mut out: Vec<(Effect, bool)> = mechanisms.iter().map(family).collect();
    out.sort_unstable();
    out.dedup();
    out
}

fn families(given: &Given, mechanisms: &[Mechanism]) -> Vec<Family> {
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

type Expanded = (Quadratic, Vec<Prior>, Vec<usize>, Vec<Hypothesis>);

fn expand(
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
    let mut hypotheses = Vec::new();
    let kinds = kinds(mechanisms);
    for m in mechanisms {
        let parameters = m.parameters.iter().map(|sized| {
            entries.push(Entry {
                parameter: sized.parameter,
                deviation: sized.deviation,
            });
            entries.len() - 1
        });
        hypotheses.push(Hypothesis {
            parameters: parameters.collect(),
            family: kinds.binary_search(&family(m)).expect("it is among them"),
        });
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
    Ok((quadratic, priors, (0..always.len()).collect(), hypotheses))
}

/// Joints on which a smooth unknown torque is more probable than not, beside the set, with its probability.
#[allow(clippy::too_many_arguments)]
fn beside(
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
    let decision = weigh(given, &with, always, arm, &replayed.blocks, noises, &start)?;
    let own = |k: usize| decision.inclusion[start.len() + k];
    Ok(moving
        .iter()
        .enumerate()
        .map(|(k, &j)| (j, own(k)))
        .filter(|(_, p)| *p >= 0.5)
        .collect())
}

/// The set without some mechanisms, fitted again in `most` iterations from where the whole set's fit stands.
///
/// # Errors
/// The simulator as given is unstable.
pub fn refit(
    given: &Given,
    replayed: &Replayed,
    found: &Found,
    set: &[usize],
    most: usize,
) -> Result<Arm, Unstable> {
    let always = tolerated(given, replayed);
    let free = free(given, &found.mechanisms, set, &always);
    let start = pinned(given, &found.fitted.arm, &free);
    Ok(fit::fit(&start, &free, &replayed.blocks, &found.fitted.noise, most)?.arm)
}
