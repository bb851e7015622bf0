//! What each cause does to the held-out recording: steps, shares, intervals, sizes.
//!
//! With r the gap as given and c_k the torques of the causes from one joint fit, the squared error of a set S
//! of causes is |r − Σ_S c_k|². Shapley's value of a game that is quadratic in its players is exact without
//! enumeration: φ_k = 2 r·c_k − c_k·Σ_l c_l.

use crate::analysis::{Columns, Findings, Frames, gap};
use crate::candidates::Candidate;
use crate::contact::{Contact, detect};
use crate::effect::Effect;
use crate::error::DiagnoseError;
use crate::ladder::{deviations, figures, total};
use crate::model::NominalModel;
use crate::report::{Cause, Parameter, Step};
use crate::scene::Scene;
use crate::select::Tried;
use ndarray::{Array1, Array2};
use physics::robot::PARAMETERS_PER_LINK;

/// How far parameters may leave the given values in the ladder, in tolerances.
const FREEDOM: f64 = 100.0;
/// Fall of some joint's NRMSE from which a change of parameters is listed.
const LISTED: f64 = 0.03;
/// Rows of a block of the bootstrap, s.
const BLOCK: f64 = 1.5;
/// Gain below which two names are one answer: in nats, and relative to the better one.
const AMBIGUOUS: (f64, f64) = (6.0, 0.08);

/// One cause's torque on the held-out recording.
struct Part {
    effect: Effect,
    accepted: Option<usize>,
    torque: Array2<f64>,
}

/// Ladder, causes, and what the last step leaves on the held-out recording.
pub struct Explanation {
    /// Steps on the held-out recording.
    pub ladder: Vec<Step>,
    /// Causes, largest share first.
    pub causes: Vec<Cause>,
    /// Held-out gap as given, shape (samples, joints).
    pub gap: Array2<f64>,
    /// Held-out residual of the last step.
    pub residual: Array2<f64>,
    /// Residual of the last step on the fitted recording, contact still in it.
    pub residual_data: Array2<f64>,
    /// Contact found in the held-out recording.
    pub contact: Option<Contact>,
}

/// Measures the findings on the held-out recording. `with_contact`: the fitted recording shows a force from
/// outside, so it is looked for in the held-out one.
///
/// # Errors
/// None beyond those of the model's own numbers.
pub fn explain(
    model: &NominalModel,
    frames: &Frames,
    found: &Findings,
    with_contact: bool,
) -> Result<Explanation, DiagnoseError> {
    let held = &frames.heldout;
    let names = model.robot.joint_names();
    let gap_held = gap(model, held, &frames.scale);
    let deviation = deviations(&held.tau);
    let scene = Scene::new(&found.present, held.motion(), &frames.scale).with_tangents();
    let columns = Columns::new(&found.dictionary, &scene, held, &found.tight.0);
    let shape = gap_held.dim();
    let step = |name: &str, residual: &Array2<f64>| Step {
        step: name.to_owned(),
        all: figures(residual, &deviation, None),
        moving: Some(figures(residual, &deviation, Some(&held.samples().qd))),
    };
    let left = |causes: &[usize]| {
        let (variables, beta) = found.refit(model, &frames.scale, causes, FREEDOM);
        &gap_held - &columns.torque(shape, &variables, &beta)
    };
    let structure: Vec<usize> =
        (0..found.accepted.len()).filter(|&c| !found.candidate(c).effect.is_parameter()).collect();
    let mut ladder = vec![step("as_given", &gap_held)];
    let mut residual = left(&[]);
    ladder.push(step("reidentified", &residual));
    for n in 1..=structure.len() {
        residual = left(&structure[..n]);
        ladder.push(step(found.candidate(structure[n - 1]).effect.name(), &residual));
    }
    let contact = if with_contact { detect(held, &residual) } else { None };
    if let Some(c) = &contact {
        residual -= &c.torque;
        ladder.push(step(Effect::ExternalContact.name(), &residual));
    }
    let mut parts = parts(model, found, &columns, shape);
    if let Some(c) = &contact {
        parts.push(Part { effect: Effect::ExternalContact, accepted: None, torque: c.torque.clone() });
    }
    let all: Array2<f64> = parts.iter().fold(Array2::zeros(shape), |sum, p| sum + &p.torque);
    let tight_residual = &gap_held - &all;
    let shares = shapley(&gap_held, &parts, &deviation);
    let mut causes = Vec::new();
    for (part, share) in parts.iter().zip(&shares) {
        let without = &tight_residual + &part.torque;
        let joints = touched(&part.torque, &tight_residual, part, found, &deviation);
        if part.effect.is_parameter() {
            let before = figures(&without, &deviation, None);
            let after = figures(&tight_residual, &deviation, None);
            let fall = before.nrmse.iter().zip(&after.nrmse).filter_map(|(b, a)| Some((*b)? - (*a)?));
            if fall.fold(f64::NEG_INFINITY, f64::max) < LISTED {
                continue;
            }
        }
        let (with, without) = match part.accepted {
            Some(c) if !part.effect.is_absorbable() => {
                let others: Vec<usize> = structure.iter().copied().filter(|&o| o != c).collect();
                let mut without = left(&others);
                if let Some(contact) = &contact {
                    without -= &contact.torque;
                }
                (residual.clone(), without)
            }
            None if part.effect == Effect::ExternalContact => (residual.clone(), &residual + &part.torque),
            _ => (tight_residual.clone(), without),
        };
        let (closed, interval) = closed(&with, &without, &joints, (BLOCK * held.report().rate_hz) as usize);
        let name = |j: &usize| names[*j].clone();
        let cause = part.accepted.map(|c| &found.accepted[c]);
        causes.push(Cause {
            effect: part.effect,
            kind: if part.effect.is_parameter() { "parameter" } else { "structure" },
            joints: joints.iter().map(name).collect(),
            driver: part.accepted.and_then(|c| found.candidate(c).driver).map(|d| names[d].clone()),
            confidence: cause.map_or(0.9, |a| confidence(found, &a.tried, a.candidate)),
            share_of_gap: *share,
            gap_closed: closed,
            gap_closed_interval: interval,
            parameters: match part.accepted {
                Some(c) => parameters(found, c, &names),
                None if part.effect == Effect::ExternalContact => {
                    contact.as_ref().map_or_else(Vec::new, |c| pushed(model, c, frames, &names))
                }
                None => moved(model, found, part.effect, &joints, &names),
            },
            ambiguous_with: cause.map_or_else(Vec::new, |a| ambiguous(found, &a.tried, a.candidate)),
        });
    }
    causes.sort_by(|a, b| b.share_of_gap.total_cmp(&a.share_of_gap));
    let data_scene = Scene::new(&found.present, frames.data.motion(), &frames.scale).with_tangents();
    let (variables, beta) = found.refit(model, &frames.scale, &structure, FREEDOM);
    let data_columns = Columns::new(&found.dictionary, &data_scene, &frames.data, &variables);
    let gap_data = gap(model, &frames.data, &frames.scale);
    let residual_data = &gap_data - &data_columns.torque(gap_data.dim(), &variables, &beta);
    Ok(Explanation { ladder, causes, gap: gap_held, residual, residual_data, contact })
}

/// Torques of all causes from the joint fit near the given parameters.
fn parts(model: &NominalModel, found: &Findings, columns: &Columns, shape: (usize, usize)) -> Vec<Part> {
    let (variables, beta) = &found.tight;
    let inertial = PARAMETERS_PER_LINK * model.robot.dof();
    let only = |keep: &dyn Fn(usize) -> bool| {
        let b: Array1<f64> = beta.iter().enumerate().map(|(i, &b)| if keep(i) { b } else { 0.0 }).collect();
        columns.torque(shape, variables, &b)
    };
    // Freed links and joints belong to the parameter entries.
    let of = |effect: Effect| -> Vec<std::ops::Range<usize>> {
        let of_effect = (0..found.accepted.len()).filter(|&c| found.candidate(c).effect == effect);
        of_effect.map(|c| found.accepted[c].variables.clone()).collect()
    };
    let (links, joints) = (of(Effect::LinkParameters), of(Effect::FrictionParameters));
    let inside = |ranges: &[std::ops::Range<usize>], i: usize| ranges.iter().any(|r| r.contains(&i));
    let mut parts = vec![
        Part {
            effect: Effect::LinkParameters,
            accepted: None,
            torque: only(&|i| i < inertial || inside(&links, i)),
        },
        Part {
            effect: Effect::FrictionParameters,
            accepted: None,
            torque: only(&|i| (inertial..found.base).contains(&i) || inside(&joints, i)),
        },
    ];
    for (c, accepted) in found.accepted.iter().enumerate() {
        let effect = found.candidate(c).effect;
        if !effect.is_parameter() {
            parts.push(Part { effect, accepted: Some(c), torque: only(&|i| accepted.variables.contains(&i)) });
        }
    }
    parts
}

/// Shares of what all causes together remove, in mean over joints of squared NRMSE; they sum to one.
fn shapley(gap: &Array2<f64>, parts: &[Part], deviation: &[Option<f64>]) -> Vec<f64> {
    let all: Array2<f64> = parts.iter().fold(Array2::zeros(gap.dim()), |sum, p| sum + &p.torque);
    let values: Vec<f64> = parts
        .iter()
        .map(|p| {
            let each = deviation.iter().enumerate().filter_map(|(j, d)| Some((j, (*d)?)));
            each.map(|(j, d)| {
                let c = p.torque.column(j);
                (2.0 * gap.column(j).dot(&c) - c.dot(&all.column(j))) / (d * d)
            })
            .sum()
        })
        .collect();
    let sum: f64 = values.iter().map(|v: &f64| v.max(0.0)).sum();
    values.iter().map(|v| if sum > 0.0 { v.max(0.0) / sum } else { 0.0 }).collect()
}

/// Joints that a cause is reported for: its own, or those whose torque it changes noticeably.
fn touched(torque: &Array2<f64>, residual: &Array2<f64>, part: &Part, found: &Findings, deviation: &[Option<f64>]) -> Vec<usize> {
    if let Some(c) = part.accepted {
        let candidate = found.candidate(c);
        let few = candidate.joints.len() < torque.ncols() || part.effect == Effect::TimeDelay;
        if few && !matches!(part.effect, Effect::Payload) {
            return candidate.joints.clone();
        }
    }
    let fall: Vec<f64> = (0..torque.ncols())
        .map(|j| {
            let Some(d) = deviation[j] else { return 0.0 };
            let (r, c) = (residual.column(j), torque.column(j));
            let without = &r + &c;
            let n = r.len().max(1) as f64;
            (((without.dot(&without) - r.dot(&r)) / n).max(0.0)).sqrt() / d
        })
        .collect();
    let most = fall.iter().copied().fold(0.0, f64::max);
    (0..fall.len()).filter(|&j| fall[j] >= 0.35 * most).collect()
}

/// Part of the joints' squared error that is removed, with a 90 % interval by bootstrap over blocks of time.
fn closed(with: &Array2<f64>, without: &Array2<f64>, joints: &[usize], block: usize) -> (f64, [f64; 2]) {
    let block = block.max(1);
    let sums: Vec<(f64, f64)> = (0..with.nrows().div_ceil(block))
        .map(|b| {
            let rows = b * block..((b + 1) * block).min(with.nrows());
            let squares = |t: &Array2<f64>| {
                joints.iter().map(|&j| rows.clone().map(|i| t[[i, j]] * t[[i, j]]).sum::<f64>()).sum::<f64>()
            };
            (squares(with), squares(without))
        })
        .collect();
    let ratio = |pick: &mut dyn Iterator<Item = usize>| {
        let (a, b) = pick.fold((0.0, 0.0), |(a, b), k| (a + sums[k].0, b + sums[k].1));
        if b > 0.0 { 1.0 - a / b } else { 0.0 }
    };
    let value = ratio(&mut (0..sums.len()));
    let mut draws: Vec<f64> = (0..200)
        .map(|seed| ratio(&mut signal::bootstrap::block_bootstrap(sums.len(), 1, seed).into_iter()))
        .collect();
    draws.sort_by(f64::total_cmp);
    let at = |p: f64| draws[(p * (draws.len() - 1) as f64).round() as usize];
    (value, [at(0.05).min(value), at(0.95).max(value)])
}

/// Coefficients as the report's quantities, shape parameters after them.
fn parameters(found: &Findings, cause: usize, names: &[String]) -> Vec<Parameter> {
    let accepted = &found.accepted[cause];
    let candidate = found.candidate(cause);
    let mut out: Vec<Parameter> = candidate
        .quantities
        .iter()
        .zip(accepted.variables.clone())
        .map(|(q, i)| Parameter {
            name: q.name.to_owned(),
            joint: q.joint.map(|j| names[j].clone()),
            value: q.offset + q.factor * found.tight.1[i],
            std: (q.factor * found.std[i]).abs(),
            unit: q.unit.to_owned(),
        })
        .collect();
    let joint = candidate.joints.first().filter(|_| candidate.joints.len() == 1).map(|&j| names[j].clone());
    let grid = |&(name, value, unit): &(&'static str, f64, &'static str)| Parameter {
        name: name.to_owned(),
        joint: joint.clone(),
        value: if value.is_finite() { value } else { 0.0 },
        std: 0.0,
        unit: unit.to_owned(),
    };
    out.extend(candidate.shape.iter().map(grid));
    derived(candidate.effect, &mut out);
    out
}

/// Quantities that users ask for, from those that are linear.
fn derived(effect: Effect, parameters: &mut Vec<Parameter>) {
    let value = |p: &[Parameter], n: &str| p.iter().find(|p| p.name == n).map(|p| (p.value, p.std));
    match effect {
        Effect::Payload => {
            let Some((mass, _)) = value(parameters, "mass") else { return };
            for p in parameters.iter_mut() {
                let name = match p.name.as_str() {
                    "first_moment_x" => "com_x",
                    "first_moment_y" => "com_y",
                    "first_moment_z" => "com_z",
                    _ => continue,
                };
                p.name = name.to_owned();
                p.value /= mass;
                p.std /= mass;
                p.unit = "m".to_owned();
            }
        }
        Effect::JointElasticity => {
            for p in parameters.iter_mut().filter(|p| p.name == "compliance" && p.value > 0.0) {
                p.name = "stiffness".to_owned();
                p.std /= p.value * p.value;
                p.value = 1.0 / p.value;
                p.unit = "N·m/rad".to_owned();
            }
        }
        _ => {}
    }
}

/// Changed parameters of the named joints that moved by more than twice their deviation.
fn moved(model: &NominalModel, found: &Findings, effect: Effect, joints: &[usize], names: &[String]) -> Vec<Parameter> {
    let n = model.robot.dof();
    let (variables, beta) = &found.tight;
    let mut out = Vec::new();
    let total = |column: usize| {
        let of = || variables.iter().enumerate().filter(move |(_, v)| v.column == column).map(|(i, _)| i);
        (of().map(|i| beta[i]).sum::<f64>(), of().map(|i| found.std[i]).fold(f64::INFINITY, f64::min))
    };
    let parameter = |name: String, j: usize, value, std, unit: &str| Parameter {
        name,
        joint: Some(names[j].clone()),
        value,
        std,
        unit: unit.to_owned(),
    };
    if effect == Effect::FrictionParameters {
        for &j in joints {
            let joint = &model.robot.joints()[j];
            let (dv, sv) = total(PARAMETERS_PER_LINK * n + j);
            let (dc, sc) = total((PARAMETERS_PER_LINK + 1) * n + j);
            out.push(parameter("viscous".into(), j, joint.damping + dv, sv, "N·m·s/rad"));
            out.push(parameter("coulomb".into(), j, joint.friction + dc, sc, "N·m"));
        }
    } else {
        let given = model.robot.parameters();
        let labels = model.robot.parameter_names();
        for (c, (p, label)) in given.iter().zip(labels).enumerate() {
            let (change, std) = total(c);
            if change.abs() > 2.0 * std && change.abs() > 0.05 * p.abs() {
                let unit = ["kg", "kg·m", "kg·m²"][[0, 1, 1, 1, 2, 2, 2, 2, 2, 2][c % PARAMETERS_PER_LINK]];
                out.push(parameter(label, c / PARAMETERS_PER_LINK, p + change, std, unit));
            }
        }
    }
    out
}

/// Force, link and time of the strongest burst.
fn pushed(model: &NominalModel, contact: &Contact, frames: &Frames, names: &[String]) -> Vec<Parameter> {
    let Some(burst) = contact.bursts.iter().max_by(|a, b| a.height.total_cmp(&b.height)) else { return Vec::new() };
    let time = &frames.heldout.samples().time;
    let joint = Some(names[burst.last_joint].clone());
    let new = |name: &str, value: f64, std: f64, unit: &str| Parameter {
        name: name.to_owned(),
        joint: joint.clone(),
        value,
        std,
        unit: unit.to_owned(),
    };
    let mut out = vec![
        new("start", time[burst.samples.start], 0.12, "s"),
        new("end", time[burst.samples.end - 1], 0.12, "s"),
        new("bursts", contact.bursts.len() as f64, 0.0, "1"),
    ];
    if let Some(force) = contact.force(&model.robot, &frames.heldout) {
        out.push(new("force", force, 0.3 * force, "N"));
    }
    out
}

/// How much more the name explains than the best other name.
fn confidence(found: &Findings, tried: &[Tried], own: usize) -> f64 {
    let effect = found.candidates[own].effect;
    let best = |f: &dyn Fn(&Candidate) -> bool| tried.iter().find(|t| f(&found.candidates[t.candidate])).map_or(0.0, |t| t.gain.max(0.0));
    let lead = best(&|c| c.effect == effect) - best(&|c| c.effect != effect);
    1.0 / (1.0 + (-lead / 8.0).exp())
}

/// Effects that explain nearly as much in its place.
fn ambiguous(found: &Findings, tried: &[Tried], own: usize) -> Vec<Effect> {
    let effect = found.candidates[own].effect;
    let gain = tried.iter().find(|t| t.candidate == own).map_or(0.0, |t| t.gain);
    let near = gain - AMBIGUOUS.0.max(AMBIGUOUS.1 * gain);
    let mut out: Vec<Effect> = Vec::new();
    for t in tried.iter().filter(|t| t.gain > near && t.gain > 0.5 * gain) {
        let e = found.candidates[t.candidate].effect;
        if e != effect && !out.contains(&e) {
            out.push(e);
        }
    }
    out
}

/// Part of the gap, as given, that the last step removes.
pub fn removed(ladder: &[Step]) -> f64 {
    let (Some(first), Some(last)) = (ladder.first(), ladder.last()) else { return 0.0 };
    1.0 - total(&last.all) / total(&first.all).max(1e-300)
}
