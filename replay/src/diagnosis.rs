//! A diagnosis of motion from the simulator as given, a recording to fit and one that measures.

use crate::arm::Arm;
use crate::catalogue::{Effect, correlations};
use crate::decide::{Found, RELATIVE, find, refit};
use crate::given::Given;
use crate::parameter::{Kind, Parameter, Scale};
use crate::schema::{
    Candidate, Cause, Controller, JointParameters, NotIdentifiable, Report, Step, UnknownJoint,
    Value,
};
use crate::score::{Errors, by_stretch, closed, figures, roll_out};
use crate::simulate::Unstable;
use crate::tracks::Replayed;
use nalgebra::{DMatrix, DVector};
use physics::robot::JointKind;
use std::collections::BTreeMap;

/// Iterations of the fit that does without a cause.
const LONG: usize = 10;
const SHORT: usize = 2;

/// Posterior correlation beyond which two values are named inseparable.
const INSEPARABLE: f64 = 0.95;

/// Weight of another effect in a cause's place from which both are named.
const AMBIGUOUS: f64 = 0.1;

/// What a diagnosis comes to.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The report.
    pub report: Report,
    /// The simulator as given.
    pub given: Arm,
    /// The simulator with every listed cause.
    pub corrected: Arm,
    /// The simulator that a model file can hold: friction without load or standstill, fitted for itself.
    pub held: Arm,
    /// Errors of the first two on the held-out recording.
    pub errors: [Errors; 2],
}

/// Diagnoses the motion: effects are found on `data`, all figures are measured on `heldout`. `fast` shortens the fits
/// without one cause each, by which shares are measured.
///
/// # Errors
/// The simulator as given is unstable.
pub fn diagnose(
    given: &Given,
    data: &Replayed,
    heldout: &Replayed,
    fast: bool,
    mut stage: impl FnMut(&str),
) -> Result<Outcome, Unstable> {
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
    let found = find(given, data, &mut stage)?;
    let corrected = found.fitted.arm.clone();
    let after = roll_out(&corrected, heldout)?;
    let spread = Spread::of(&found);
    let groups = groups(&found);
    stage("measuring each cause");
    let mut causes = Vec::new();
    let mut losses = Vec::new();
    for (effect, members) in &groups {
        let others: Vec<usize> = found
            .decision
            .set
            .iter()
            .copied()
            .filter(|m| !members.contains(m))
            .collect();
        let arm = without(given, data, &found, &others, fast)?;
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
    // What the held-out recording does not confirm never stands first.
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
        set.extend(&groups[i].1);
        let errors = if k + 1 == order.len() {
            after.clone()
        } else {
            roll_out(&without(given, data, &found, &set, fast)?, heldout)?
        };
        ladder.push(Step {
            step: causes[i].effect.to_owned(),
            figures: figures(&errors, heldout),
        });
    }
    stage("fitting what a model file holds");
    let held = held(given, data, &found)?;
    let alone = figures(&roll_out(&held, heldout)?, heldout);
    let places = crate::place::places(&before, heldout, &joints, &rotates);
    let causes: Vec<Cause> = order.iter().map(|&i| causes[i].clone()).collect();
    let unknown: Vec<UnknownJoint> = found
        .unknown
        .iter()
        .map(|&(j, probability)| UnknownJoint {
            joint: joints[j].clone(),
            probability,
        })
        .collect();
    let floors = floors(heldout);
    let verdict = verdict(&after, heldout, &floors, &causes, &unknown);
    let report = Report {
        schema: "replay/1",
        verdict,
        reason: (verdict == "cannot_tell").then(|| {
            "more is left than noise explains, without a cause and without a pattern".to_owned()
        }),
        ladder,
        file_alone: alone,
        places,
        candidates: candidates(&found, &joints),
        not_identifiable: not_identifiable(&found, &spread, data, &joints),
        unknown,
        controller: controller(given, &corrected, &found, &spread),
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

/// Sum over joints of squared unexplained parts.
fn unexplained(errors: &Errors, replayed: &Replayed) -> f64 {
    figures(errors, replayed)
        .unexplained
        .iter()
        .flatten()
        .map(|u| u * u)
        .sum()
}

/// The arm with other mechanisms than the found ones.
fn without(
    given: &Given,
    data: &Replayed,
    found: &Found,
    set: &[usize],
    fast: bool,
) -> Result<Arm, Unstable> {
    refit(given, data, found, set, if fast { SHORT } else { LONG })
}

/// The arm with the causes that a model file can hold; what stands in for friction by load or at standstill is Coulomb and
/// viscous friction of the same joints.
fn held(given: &Given, data: &Replayed, found: &Found) -> Result<Arm, Unstable> {
    let outside = |m: usize| {
        let effect = found.mechanisms[m].effect;
        matches!(
            effect,
            Effect::LoadDependentFriction | Effect::StribeckFriction
        )
    };
    let set = &found.decision.set;
    if !set.iter().any(|&m| outside(m)) {
        return Ok(found.fitted.arm.clone());
    }
    let joints: Vec<Option<usize>> = set
        .iter()
        .filter(|&&m| outside(m))
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
    refit(given, data, found, &kept, LONG)
}

/// Listed mechanisms by effect.
fn groups(found: &Found) -> Vec<(Effect, Vec<usize>)> {
    let mut out: BTreeMap<Effect, Vec<usize>> = BTreeMap::new();
    for &m in &found.decision.set {
        if found.decision.inclusion[m] >= 0.5 {
            out.entry(found.mechanisms[m].effect).or_default().push(m);
        }
    }
    out.into_iter().collect()
}

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

fn confidence(found: &Found, members: &[usize]) -> f64 {
    members
        .iter()
        .map(|&m| found.decision.inclusion[m])
        .fold(1.0, f64::min)
}

fn kind(effect: Effect) -> &'static str {
    match effect {
        Effect::FrictionParameters | Effect::LinkParameters => "parameter",
        _ => "structure",
    }
}

fn ambiguous(
    found: &Found,
    effect: Effect,
    members: &[usize],
    data: &Replayed,
) -> Vec<&'static str> {
    let mut names: Vec<&'static str> = Vec::new();
    for &m in members {
        let Ok(at) = found.decision.set.binary_search(&m) else {
            continue;
        };
        for swap in found.decision.swaps[at]
            .iter()
            .filter(|s| s.weight >= AMBIGUOUS)
        {
            names.push(found.mechanisms[swap.other].effect.name());
        }
    }
    // Without commanded velocities the drive's damping and viscous friction are one number.
    if data.whole.iter().any(|t| t.rates.is_none()) {
        match effect {
            Effect::FrictionParameters => names.push(Effect::ServoDamping.name()),
            Effect::ServoDamping => names.push(Effect::FrictionParameters.name()),
            _ => {}
        }
    }
    names.sort_unstable();
    names.dedup();
    names.retain(|n| *n != effect.name());
    names
}

/// Standard deviations and correlations of the fitted coordinates.
struct Spread {
    deviation: Vec<f64>,
    prior: Vec<f64>,
    correlation: DMatrix<f64>,
}

impl Spread {
    /// The posterior's covariance, or the spread of fits with one block left out, whichever is wider.
    fn of(found: &Found) -> Self {
        let p = found.free.len();
        let prior: Vec<f64> = found
            .free
            .iter()
            .map(|f| f.prior.map_or(f64::INFINITY, |p| p.1))
            .collect();
        let mut precision = found.fitted.information.clone();
        for i in 0..p {
            precision[(i, i)] += prior[i].powi(-2);
        }
        let covariance = precision.clone().cholesky().map_or_else(
            || DMatrix::from_diagonal_element(p, p, f64::NAN),
            |c| c.inverse(),
        );
        let left_out = jackknife(found, &precision);
        let deviation = (0..p)
            .map(|i| {
                covariance[(i, i)]
                    .sqrt()
                    .max(left_out.as_ref().map_or(0.0, |d| d[i]))
                    .min(prior[i])
            })
            .collect();
        Self {
            deviation,
            prior,
            correlation: correlations(&covariance),
        }
    }
}

/// Deviations by one Newton step from the fit to that without each block; none of fewer than four blocks.
fn jackknife(found: &Found, precision: &DMatrix<f64>) -> Option<Vec<f64>> {
    let blocks = &found.fitted.blocks;
    let m = blocks.len();
    if m < 4 {
        return None;
    }
    let totals = crate::fit::by_trajectory(blocks);
    let p = found.free.len();
    let mut steps: Vec<DVector<f64>> = Vec::new();
    for block in blocks {
        let total = totals.iter().find(|t| t.trajectory == block.trajectory)?;
        let mut gradient = DVector::zeros(p);
        let mut information = DMatrix::zeros(p, p);
        for (j, noise) in found.fitted.noise.iter().enumerate() {
            let variance = total.squared[j] / total.samples + noise.floor;
            let weight = 1.0 / (noise.correlation * variance);
            gradient += &block.gradient[j] * weight;
            information += &block.hessian[j] * weight;
        }
        let slopes = DVector::from_iterator(
            p,
            found.free.iter().zip(&found.fitted.x).map(|(f, x)| {
                if f.parameter.kind.scale() == Scale::Log {
                    x.exp()
                } else {
                    1.0
                }
            }),
        );
        gradient.component_mul_assign(&slopes);
        let scaled = DMatrix::from_fn(p, p, |i, k| information[(i, k)] * slopes[i] * slopes[k]);
        steps.push((precision - scaled).cholesky()?.solve(&gradient));
    }
    let mean: DVector<f64> = steps.iter().fold(DVector::zeros(p), |s, v| s + v) / m as f64;
    let factor = (m as f64 - 1.0) / m as f64;
    let square = |i: usize| steps.iter().map(|s| (s[i] - mean[i]).powi(2)).sum::<f64>();
    Some((0..p).map(|i| (factor * square(i)).sqrt()).collect())
}

/// Name and unit of a parameter in the report.
fn named(kind: Kind, rotates: bool) -> (&'static str, &'static str) {
    let unit = |r: &'static str, t: &'static str| if rotates { r } else { t };
    match kind {
        Kind::Gain => ("kp", unit("N·m/rad", "N/m")),
        Kind::ServoDamping => ("kd", unit("N·m·s/rad", "N·s/m")),
        Kind::Integral => ("ki", unit("N·m/(rad·s)", "N/(m·s)")),
        Kind::DriveLimit => ("voltage", unit("N·m", "N")),
        Kind::Limit => ("limit", unit("N·m", "N")),
        Kind::DeadBand => ("dead_band", unit("rad", "m")),
        Kind::Delay | Kind::CommonDelay | Kind::Lag => ("delay", "s"),
        Kind::Acceleration => ("acceleration", unit("rad/s²", "m/s²")),
        Kind::Offset => ("command_zero", unit("rad", "m")),
        Kind::Damping => ("viscous", unit("N·m·s/rad", "N·s/m")),
        Kind::Coulomb => ("coulomb", unit("N·m", "N")),
        Kind::Stribeck => ("stribeck", unit("N·m", "N")),
        Kind::StribeckVelocity => ("stribeck_velocity", unit("rad/s", "m/s")),
        Kind::Load => ("load", "1"),
        Kind::Armature => ("inertia", unit("kg·m²", "kg")),
        Kind::GravityCompensation => ("gain", "1"),
        Kind::Payload(0) => ("mass", "kg"),
        Kind::Payload(1) => ("com_x", "m"),
        Kind::Payload(2) => ("com_y", "m"),
        Kind::Payload(_) => ("com_z", "m"),
        Kind::LinkScale => ("mass_factor", "1"),
        Kind::Tilt(0) => ("tilt_x", "rad"),
        Kind::Tilt(_) => ("tilt_y", "rad"),
        Kind::Zero => ("zero", unit("rad", "m")),
        Kind::Unknown(_) => ("unknown", unit("N·m", "N")),
    }
}

/// Whether a value is a torque per something, so that its scale is that of the description's masses.
fn is_torque(kind: Kind) -> bool {
    matches!(
        kind,
        Kind::Gain
            | Kind::ServoDamping
            | Kind::Integral
            | Kind::DriveLimit
            | Kind::Limit
            | Kind::Damping
            | Kind::Coulomb
            | Kind::Stribeck
            | Kind::Armature
            | Kind::Payload(_)
    )
}

/// Standard deviation of a fitted value; none where it is given.
fn deviation(found: &Found, spread: &Spread, parameter: Parameter) -> Option<f64> {
    let at = found.free.iter().position(|f| f.parameter == parameter)?;
    let value = found.fitted.arm.get(parameter);
    let own = if parameter.kind.scale() == Scale::Log {
        value * spread.deviation[at]
    } else {
        spread.deviation[at]
    };
    let masses = if is_torque(parameter.kind) {
        RELATIVE * value
    } else {
        0.0
    };
    Some(own.hypot(masses))
}

fn values(
    given: &Given,
    found: &Found,
    spread: &Spread,
    members: &[usize],
    joints: &[String],
) -> Vec<Value> {
    let mut out = Vec::new();
    for &m in members {
        for sized in &found.mechanisms[m].parameters {
            let p = sized.parameter;
            let value = found.fitted.arm.get(p);
            // A number at its bound is no estimate.
            if p.kind.scale() == Scale::Positive && value <= 0.0 {
                continue;
            }
            let kind = given.arm.robot.joints()[p.joint].kind;
            let (name, unit) = named(p.kind, kind != JointKind::Prismatic);
            // First moments are fitted; a reader wants the centre of mass.
            let mass = found.fitted.arm.payload[0];
            let per = match p.kind {
                Kind::Payload(1..) if mass > 0.0 => mass,
                Kind::Payload(1..) => continue,
                _ => 1.0,
            };
            out.push(Value {
                name,
                joint: (!p.kind.is_common()).then(|| joints[p.joint].clone()),
                given: given.arm.get(p),
                value: value / per,
                std: deviation(found, spread, p)
                    .map(|v| v / per)
                    .filter(|v| v.is_finite()),
                unit,
            });
        }
    }
    out
}

/// Effects that were weighed and are not listed, from a probability of one in a hundred on.
fn candidates(found: &Found, joints: &[String]) -> Vec<Candidate> {
    let mut out: Vec<Candidate> = (0..found.mechanisms.len())
        .filter(|m| found.decision.inclusion[*m] < 0.5 && found.decision.inclusion[*m] > 0.01)
        .map(|m| Candidate {
            effect: found.mechanisms[m].effect.name(),
            joints: match found.mechanisms[m].joint {
                Some(j) => vec![joints[j].clone()],
                None => joints.to_vec(),
            },
            probability: found.decision.inclusion[m],
        })
        .collect();
    out.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    out
}

fn not_identifiable(
    found: &Found,
    spread: &Spread,
    data: &Replayed,
    joints: &[String],
) -> Vec<NotIdentifiable> {
    let effect_of = |p: Parameter| {
        let own = found.decision.set.iter().find(|&&m| {
            found.mechanisms[m]
                .parameters
                .iter()
                .any(|s| s.parameter == p)
        });
        own.map(|&m| found.mechanisms[m].effect.name())
    };
    let place = |p: Parameter| {
        if p.kind.is_common() {
            joints.to_vec()
        } else {
            vec![joints[p.joint].clone()]
        }
    };
    let say = |p: Parameter| {
        let (name, _) = named(p.kind, true);
        if p.kind.is_common() {
            name.to_owned()
        } else {
            format!("{name} of {}", joints[p.joint])
        }
    };
    let mut out = Vec::new();
    for j in (0..joints.len()).filter(|&j| !data.moves[j]) {
        out.push(NotIdentifiable {
            effect: None,
            joints: vec![joints[j].clone()],
            reason: "it never moves, and no command asks it to".to_owned(),
        });
    }
    for (i, f) in found.free.iter().enumerate() {
        let p = f.parameter;
        let bound = p.kind.scale() == Scale::Positive && found.fitted.x[i] <= 0.0;
        if bound && effect_of(p).is_some() {
            out.push(NotIdentifiable {
                effect: effect_of(p),
                joints: place(p),
                reason: format!(
                    "{} is not told from zero; it is below {:.2e}",
                    say(p),
                    2.0 * spread.deviation[i]
                ),
            });
        } else if spread.deviation[i] > 0.5 * spread.prior[i] {
            out.push(NotIdentifiable {
                effect: effect_of(p),
                joints: place(p),
                reason: format!(
                    "this motion does not halve what was assumed of {}; move faster, with load and with reversals",
                    say(p)
                ),
            });
        }
        for (k, other) in found.free.iter().enumerate().take(i) {
            let r = spread.correlation[(i, k)];
            if r.abs() > INSEPARABLE {
                out.push(NotIdentifiable {
                    effect: effect_of(p).or_else(|| effect_of(other.parameter)),
                    joints: place(p),
                    reason: format!(
                        "{} and {} cannot be told apart (correlation {r:.2}): {}",
                        say(other.parameter),
                        say(p),
                        if r > 0.0 {
                            "only their difference is known"
                        } else {
                            "only their sum is known"
                        }
                    ),
                });
            }
        }
    }
    out
}

fn controller(given: &Given, arm: &Arm, found: &Found, spread: &Spread) -> Controller {
    let n = arm.dof();
    let std = |kind: Kind| -> Vec<Option<f64>> {
        (0..n)
            .map(|j| deviation(found, spread, Parameter::new(kind, j)).filter(|v| v.is_finite()))
            .collect()
    };
    let common = deviation(found, spread, Parameter::new(Kind::CommonDelay, 0));
    let lags = std(Kind::Lag);
    Controller {
        kind: given.controller,
        kp: arm.servos.iter().map(|s| s.kp).collect(),
        kp_std: std(Kind::Gain),
        kd: arm.servos.iter().map(|s| s.kd).collect(),
        kd_std: std(Kind::ServoDamping),
        delay: arm.servos.iter().map(|s| s.delay + s.lag).collect(),
        delay_std: lags.into_iter().map(|l| l.or(common)).collect(),
        limit: arm
            .servos
            .iter()
            .map(|s| s.limit.min(s.drive_limit))
            .map(|l| l.is_finite().then_some(l))
            .collect(),
        command_zero: arm.servos.iter().map(|s| s.offset).collect(),
        gravity_compensation: arm.gravity_compensation,
    }
}

/// Noise of each joint's positions: by third differences, in which smooth motion vanishes, and no less than the quantum's.
fn floors(replayed: &Replayed) -> Vec<f64> {
    (0..replayed.tracking.len())
        .map(|j| {
            let (mut sum, mut count) = (0.0, 0.0);
            for track in &replayed.whole {
                let q = track.q.column(j);
                for k in 3..q.len() {
                    sum += (q[k] - 3.0 * q[k - 1] + 3.0 * q[k - 2] - q[k - 3]).powi(2);
                    count += 1.0;
                }
            }
            // Of white noise third differences have 20 times the variance.
            let noise: f64 = (sum / f64::max(count, 1.0) / 20.0).sqrt();
            noise.max(replayed.quantum[j] / 12.0_f64.sqrt())
        })
        .collect()
}

/// Largest multiple of the floor, and largest unexplained part, at which a joint has no gap.
const AT_FLOOR: f64 = 1.5;
const SMALL: f64 = 0.05;

fn verdict(
    after: &Errors,
    heldout: &Replayed,
    floors: &[f64],
    causes: &[Cause],
    unknown: &[UnknownJoint],
) -> &'static str {
    let figures = figures(after, heldout);
    let joints = figures.rmse.iter().zip(&figures.unexplained).zip(floors);
    let done = joints.filter_map(|((r, u), floor)| Some(((*r)?, (*u)?, floor)));
    let small = done
        .into_iter()
        .all(|(r, u, floor)| r <= AT_FLOOR * floor || u <= SMALL);
    match (small, causes.is_empty(), unknown.is_empty()) {
        (true, true, _) => "no_gap",
        (true, false, _) => "explained",
        (false, _, false) => "unknown_effect",
        (false, false, true) => "partly_explained",
        (false, true, true) => "cannot_tell",
    }
}
