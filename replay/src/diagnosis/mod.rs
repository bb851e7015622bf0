//! Diagnosis of motion from the simulator as given, a recording to fit and a held-out one.

mod ceiling;
mod doubts;
mod earlier;
mod spread;
mod values;
mod verdict;

pub use earlier::earlier;

use ceiling::ceiling;
use doubts::{ambiguous, candidates, not_identifiable};
use spread::Spread;
use values::{controller, values};
use verdict::{left, verdict};

use crate::arm::Arm;
use crate::catalogue::Effect;
use crate::decide::{COARSE, Found, find, named, refit, refit_finely, tempered};
use crate::fit::Effort;
use crate::given::Given;
use crate::schema::{Cause, FileAlone, JointParameters, REPEATABILITY, Report, Step, UnknownJoint};
use crate::score::{Errors, by_stretch, closed, figures, of_rmse, roll_out};
use crate::simulate::Unstable;
use crate::tracks::Replayed;
use physics::robot::JointKind;
use std::collections::BTreeMap;

/// Effort of fits that leave one cause out, which measure the causes' shares. A nat is one standard deviation of one
/// parameter.
const LONG: Effort = Effort {
    iterations: 8,
    gain: 1.0,
    step: COARSE,
};

/// Effort of the fits that leave one cause out where a fast diagnosis is asked for.
const SHORT: Effort = Effort {
    iterations: 2,
    ..LONG
};

/// Power to which the odds of what is said are taken: the evidence counts errors of the model as noise, and is too sure. With it
/// the cases of `replay prove --cases 26 --seed 6007 --joints 5` and of MuJoCo by seed 4711 are right as often as is said.
const TEMPER: f64 = 0.14;

/// Name of the ladder's step with fitted values of parameters that have a tolerance. It is there only where no cause is
/// listed.
pub const TOLERANCES: &str = "tolerances";

/// What is asked for beyond the causes and their shares: `Options::default().fast(true)`.
#[derive(Debug, Clone, Copy, Default)]
#[non_exhaustive]
pub struct Options {
    /// Whether fits that leave one cause out end early.
    pub fast: bool,
    /// Whether the corrected simulator is fitted to the held-out recording itself, too, as `ceiling` of the report.
    pub ceiling: bool,
}

impl Options {
    /// Options with fits that leave one cause out ended early, or not: causes' shares are then rougher.
    pub fn fast(mut self, fast: bool) -> Self {
        self.fast = fast;
        self
    }

    /// Options with the corrected simulator fitted to the held-out recording itself, too, or not.
    pub fn ceiling(mut self, ceiling: bool) -> Self {
        self.ceiling = ceiling;
        self
    }
}

/// Outcome of a diagnosis: the report, and the simulators that it compares.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Report of the diagnosis.
    pub report: Report,
    /// Simulator as given.
    pub given: Arm,
    /// Simulator with every listed cause, fitted.
    pub corrected: Arm,
    /// Simulator that a model file can hold: without couplings and friction by load or at standstill, fitted again without.
    pub held: Arm,
    /// Errors on the held-out recording of the simulator as given and of the corrected one, in this order.
    pub errors: [Errors; 2],
}

/// Diagnoses the motion. Effects are found on `data`, and all figures are measured on `heldout`. `stage` is called with the
/// name of each step.
///
/// # Errors
/// Simulator as given that is unstable.
pub fn diagnose(
    given: &Given,
    data: &Replayed,
    heldout: &Replayed,
    options: Options,
    mut stage: impl FnMut(&str),
) -> Result<Outcome, Unstable> {
    let fast = options.fast;
    stage("replaying the simulator as given");
    let joints = given.arm.robot.joint_names();
    let rotates: Vec<bool> = given
        .arm
        .robot
        .joints()
        .iter()
        .map(|j| j.kind != JointKind::Prismatic)
        .collect();
    let before = roll_out(&given.arm, heldout)?;
    let as_given = given.arm.clone();
    let merged = given.without_rates();
    let rates = data.whole.iter().all(|t| t.rates.is_some());
    let given = if rates { given } else { &merged };
    let given = &given.limited(data)?;
    let found = find(given, data, &mut stage)?;
    let plain = named(given, data, &found)?;
    let listed = &plain.decision.set;
    let corrected = given.released(&plain.fitted.arm);
    let after = roll_out(&corrected, heldout)?;
    let spread = Spread::of(&found);
    let groups = groups(&found);
    stage("measuring each cause");
    let mut causes = Vec::new();
    let mut losses = Vec::new();
    for (effect, driver, members) in &groups {
        let others = listed.iter().copied().filter(|m| !members.contains(m));
        let others: Vec<usize> = others.collect();
        let arm = without(given, data, &plain, &others, fast)?;
        let lost = roll_out(&arm, heldout)?;
        let touched = touched(&found, members, joints.len());
        let (whole, interval) = closed(
            &by_stretch(&lost, heldout, &touched),
            &by_stretch(&after, heldout, &touched),
        );
        losses.push(unexplained(&lost, heldout) - unexplained(&after, heldout));
        causes.push(Cause {
            effect: effect.name(),
            kind: kind(*effect),
            joints: touched.iter().map(|&j| joints[j].clone()).collect(),
            driver: driver.map(|j| joints[j].clone()),
            confidence: confidence(&found, members),
            share_of_gap: 0.0,
            gap_closed: whole,
            gap_closed_interval: interval,
            confirmed: interval[0] > 0.0,
            p_value: None,
            parameters: values(given, &found, &spread, members, &joints),
            ambiguous_with: ambiguous(&found, *effect, members, data),
        });
    }
    let sum: f64 = losses.iter().map(|l| l.max(0.0)).sum();
    for (cause, loss) in causes.iter_mut().zip(&losses) {
        cause.share_of_gap = if sum > 0.0 { loss.max(0.0) / sum } else { 0.0 };
    }
    let mut order: Vec<usize> = (0..causes.len()).collect();
    // Order: causes that the held-out recording confirms come first.
    order.sort_by(|&a, &b| {
        let key = |i: usize| (causes[i].confirmed, causes[i].share_of_gap);
        key(b)
            .partial_cmp(&key(a))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    stage("climbing the ladder");
    let mut ladder = vec![Step {
        step: "as_given".to_owned(),
        figures: figures(&before, heldout),
    }];
    let mut set: Vec<usize> = Vec::new();
    for (k, &i) in order.iter().enumerate() {
        set.extend(&groups[i].2);
        let errors = if k + 1 == order.len() {
            after.clone()
        } else {
            roll_out(&without(given, data, &plain, &set, fast)?, heldout)?
        };
        ladder.push(Step {
            step: causes[i].effect.to_owned(),
            figures: figures(&errors, heldout),
        });
    }
    let places = crate::place::places(&before, heldout, &joints, &rotates);
    let causes: Vec<Cause> = order.iter().map(|&i| causes[i].clone()).collect();
    let left_as_given = left(&before, heldout, given);
    let left = left(&after, heldout, given);
    let unknown: Vec<UnknownJoint> = found
        .unknown()
        .into_iter()
        .filter(|(j, _)| left[*j])
        .map(|(j, probability)| UnknownJoint {
            joint: joints[j].clone(),
            probability: tempered(probability, TEMPER),
        })
        .collect();
    let verdict = verdict([&left_as_given, &left], &causes, &unknown);
    // What follows the motion as given stays as it is.
    let held = if verdict == "no_gap" && given.earlier.is_none() {
        as_given.clone()
    } else {
        stage("fitting what a model file holds");
        given.released(&held(given, data, &plain)?)
    };
    let alone = FileAlone {
        figures: figures(&roll_out(&held, heldout)?, heldout),
        controller: controller(given, &held, None),
    };
    if causes.is_empty() && verdict == "explained" && given.earlier.is_none() {
        ladder.push(Step {
            step: TOLERANCES.to_owned(),
            figures: figures(&after, heldout),
        });
    }
    if let Some(rmse) = &heldout.repeats {
        ladder.push(Step {
            step: REPEATABILITY.to_owned(),
            figures: of_rmse(rmse, heldout),
        });
    }
    let ceiling = if options.ceiling {
        stage("fitting to the held-out recording itself");
        Some(ceiling(&plain, heldout)?)
    } else {
        None
    };
    let report = Report {
        schema: "replay/1",
        verdict,
        compared: None,
        reason: (verdict == "cannot_tell").then(|| {
            "more is left than noise explains, without a cause and without a pattern".to_owned()
        }),
        ladder,
        file_alone: alone,
        ceiling,
        places,
        candidates: candidates(&found, &joints),
        not_identifiable: not_identifiable(given, &found, &spread, data, &joints),
        unknown,
        controller: controller(
            given,
            &given.released(&found.fitted.arm),
            Some((&found, &spread)),
        ),
        joint_parameters: JointParameters {
            damping: corrected.joints.iter().map(|j| j.damping).collect(),
            frictionloss: corrected.joints.iter().map(|j| j.coulomb).collect(),
            armature: corrected.joints.iter().map(|j| j.armature).collect(),
        },
        notes: given.notes.clone(),
        causes,
        joints,
    };
    Ok(Outcome {
        report,
        given: as_given,
        corrected,
        held,
        errors: [before, after],
    })
}

/// Sum over joints of the squared ratio of simulation error to tracking error.
fn unexplained(errors: &Errors, replayed: &Replayed) -> f64 {
    figures(errors, replayed)
        .unexplained
        .iter()
        .flatten()
        .map(|u| u * u)
        .sum()
}

/// Arm fitted with the mechanisms `set` instead of the found ones.
fn without(
    given: &Given,
    data: &Replayed,
    found: &Found,
    set: &[usize],
    fast: bool,
) -> Result<Arm, Unstable> {
    refit(given, data, found, set, if fast { SHORT } else { LONG })
}

/// Arm with the causes that a model file can hold. Couplings are left out. Friction by load or at standstill is replaced by
/// Coulomb and viscous friction of the same joints.
fn held(given: &Given, data: &Replayed, found: &Found) -> Result<Arm, Unstable> {
    let outside = |m: usize| {
        let effect = found.mechanisms[m].effect;
        matches!(
            effect,
            Effect::LoadDependentFriction | Effect::StribeckFriction | Effect::JointCoupling
        )
    };
    let set = &found.decision.set;
    if !set.iter().any(|&m| outside(m)) {
        return Ok(found.fitted.arm.clone());
    }
    let joints: Vec<Option<usize>> = set
        .iter()
        .filter(|&&m| outside(m) && found.mechanisms[m].effect != Effect::JointCoupling)
        .map(|&m| found.mechanisms[m].joint)
        .collect();
    let stands_in = |m: &usize| {
        let own = &found.mechanisms[*m];
        own.effect == Effect::FrictionParameters && joints.contains(&own.joint)
    };
    let kept = set.iter().copied().filter(|&m| !outside(m));
    let mut kept: Vec<usize> = kept
        .chain((0..found.mechanisms.len()).filter(stands_in))
        .collect();
    kept.sort_unstable();
    kept.dedup();
    Ok(refit_finely(given, data, found, &kept)?.1.arm)
}

/// Mechanisms of the found set with an inclusion probability of at least 0.5, by effect and, of couplings, by driving joint.
/// Each group becomes one cause.
fn groups(found: &Found) -> Vec<(Effect, Option<usize>, Vec<usize>)> {
    let mut out: BTreeMap<(Effect, Option<usize>), Vec<usize>> = BTreeMap::new();
    for m in found.named() {
        if found.decision.inclusion[m] >= 0.5 {
            let own = &found.mechanisms[m];
            out.entry((own.effect, own.driver())).or_default().push(m);
        }
    }
    out.into_iter()
        .map(|((effect, driver), members)| (effect, driver, members))
        .collect()
}

/// Indices of the joints that these mechanisms act on; all `n` where one acts on the whole arm.
fn touched(found: &Found, members: &[usize], n: usize) -> Vec<usize> {
    if members.iter().any(|&m| found.mechanisms[m].joint.is_none()) {
        return (0..n).collect();
    }
    let mut joints: Vec<usize> = members
        .iter()
        .filter_map(|&m| found.mechanisms[m].joint)
        .collect();
    joints.sort_unstable();
    joints
}

/// Smallest inclusion probability of these mechanisms.
fn confidence(found: &Found, members: &[usize]) -> f64 {
    let each = members.iter().map(|&m| found.decision.inclusion[m]);
    tempered(each.fold(1.0, f64::min), TEMPER)
}

/// Kind of an effect in the report: `parameter` or `structure`.
fn kind(effect: Effect) -> &'static str {
    match effect {
        Effect::FrictionParameters | Effect::LinkParameters => "parameter",
        _ => "structure",
    }
}
