//! What each cause does to the held-out recording: steps, shares, intervals, sizes.
//!
//! With r the gap as given and c_k the torques of the causes from one joint fit, the squared error of a set S
//! of causes is |r − Σ_S c_k|². Shapley's value of a game that is quadratic in its players is exact without
//! enumeration: φ_k = 2 r·c_k − c_k·Σ_l c_l.

use crate::analysis::{Accepted, Columns, Findings, Frames, gap};
use crate::contact::{Contact, detect};
use crate::effect::Effect;
use crate::error::DiagnoseError;
use crate::ladder::{deviations, figures, total};
use crate::model::NominalModel;
use crate::quantities::{ambiguous, confidence, limit, moved, parameters, pushed};
use crate::report::{Cause, Step};
use crate::saturated::saturated;
use crate::scene::Scene;
use ndarray::{Array1, Array2};
use physics::robot::PARAMETERS_PER_LINK;

/// How far parameters may leave the given values in the ladder, in tolerances.
const FREEDOM: f64 = 100.0;
/// Fall of some joint's NRMSE from which a change of parameters is listed.
const LISTED: f64 = 0.03;
/// Rows of a block of the bootstrap, s.
const BLOCK: f64 = 1.5;

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
    /// Sum over joints of squared NRMSE as given, on the fitted recording.
    pub given_data: f64,
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
    let structure: Vec<usize> = (0..found.accepted.len())
        .filter(|&c| !found.candidate(c).effect.is_parameter())
        .collect();
    let mut ladder = vec![step("as_given", &gap_held)];
    let mut residual = left(&[]);
    ladder.push(step("reidentified", &residual));
    for n in 1..=structure.len() {
        residual = left(&structure[..n]);
        ladder.push(step(
            found.candidate(structure[n - 1]).effect.name(),
            &residual,
        ));
    }
    let mut parts = parts(model, found, &columns, shape);
    // What is measured in the held-out recording itself.
    let mut local = Array2::zeros(shape);
    let cuts = match found.settings.withheld {
        Some(Effect::Saturation) => Vec::new(),
        _ => saturated(held, &residual),
    };
    for cut in &cuts {
        local += &cut.torque;
        residual -= &cut.torque;
        ladder.push(step(Effect::Saturation.name(), &residual));
        parts.push(Part {
            effect: Effect::Saturation,
            accepted: None,
            torque: cut.torque.clone(),
        });
    }
    let contact = if with_contact {
        detect(held, &residual)
    } else {
        None
    };
    if let Some(c) = &contact {
        local += &c.torque;
        residual -= &c.torque;
        ladder.push(step(Effect::ExternalContact.name(), &residual));
        parts.push(Part {
            effect: Effect::ExternalContact,
            accepted: None,
            torque: c.torque.clone(),
        });
    }
    let all: Array2<f64> = parts
        .iter()
        .fold(Array2::zeros(shape), |sum, p| sum + &p.torque);
    let tight_residual = &gap_held - &all;
    let shares = shapley(&gap_held, &parts, &deviation);
    let mut causes = Vec::new();
    for (part, share) in parts.iter().zip(&shares) {
        let without = &tight_residual + &part.torque;
        let joints = touched(&part.torque, &tight_residual, part, found, &deviation);
        if part.effect.is_parameter() {
            let before = figures(&without, &deviation, None);
            let after = figures(&tight_residual, &deviation, None);
            let fall = before
                .nrmse
                .iter()
                .zip(&after.nrmse)
                .filter_map(|(b, a)| Some((*b)? - (*a)?));
            if fall.fold(f64::NEG_INFINITY, f64::max) < LISTED {
                continue;
            }
        }
        let (with, without) = match part.accepted {
            Some(c) if !part.effect.is_absorbable() => {
                let others: Vec<usize> = structure.iter().copied().filter(|&o| o != c).collect();
                (residual.clone(), left(&others) - &local)
            }
            None if !part.effect.is_parameter() => (residual.clone(), &residual + &part.torque),
            _ => (tight_residual.clone(), without),
        };
        let (closed, interval) = closed(
            &with,
            &without,
            &joints,
            (BLOCK * held.report().rate_hz) as usize,
        );
        let name = |j: &usize| names[*j].clone();
        let cause = part.accepted.map(|c| &found.accepted[c]);
        causes.push(Cause {
            effect: part.effect,
            kind: if part.effect.is_parameter() {
                "parameter"
            } else {
                "structure"
            },
            joints: joints.iter().map(name).collect(),
            driver: part
                .accepted
                .and_then(|c| found.candidate(c).driver)
                .map(|d| names[d].clone()),
            confidence: cause.map_or(0.9, |a| confidence(found, &a.tried, a.candidate)),
            share_of_gap: *share,
            gap_closed: closed,
            gap_closed_interval: interval,
            parameters: match part.accepted {
                Some(c) => parameters(found, c, &names),
                None if part.effect == Effect::ExternalContact => contact
                    .as_ref()
                    .map_or_else(Vec::new, |c| pushed(model, c, frames, &names)),
                None if part.effect == Effect::Saturation => limit(&cuts, &joints, &names),
                None => moved(model, found, part.effect, &joints, &names),
            },
            ambiguous_with: cause
                .or_else(|| suspected(found, part.effect))
                .map_or_else(Vec::new, |a| ambiguous(found, &a.tried, a.candidate)),
        });
    }
    causes.sort_by(|a, b| b.share_of_gap.total_cmp(&a.share_of_gap));
    let data_scene =
        Scene::new(&found.present, frames.data.motion(), &frames.scale).with_tangents();
    let (variables, beta) = found.refit(model, &frames.scale, &structure, FREEDOM);
    let data_columns = Columns::new(&found.dictionary, &data_scene, &frames.data, &variables);
    let gap_data = gap(model, &frames.data, &frames.scale);
    let residual_data = &gap_data - &data_columns.torque(gap_data.dim(), &variables, &beta);
    Ok(Explanation {
        ladder,
        causes,
        gap: gap_held,
        residual,
        residual_data,
        given_data: total(&figures(&gap_data, &deviations(&frames.data.tau), None)),
        contact,
    })
}

/// Torques of all causes from the joint fit near the given parameters.
fn parts(
    model: &NominalModel,
    found: &Findings,
    columns: &Columns,
    shape: (usize, usize),
) -> Vec<Part> {
    let (variables, beta) = &found.tight;
    let inertial = PARAMETERS_PER_LINK * model.robot.dof();
    let only = |keep: &dyn Fn(usize) -> bool| {
        let b: Array1<f64> = beta
            .iter()
            .enumerate()
            .map(|(i, &b)| if keep(i) { b } else { 0.0 })
            .collect();
        columns.torque(shape, variables, &b)
    };
    // Freed links and joints belong to the parameter entries.
    let of = |effect: Effect| -> Vec<std::ops::Range<usize>> {
        let of_effect = (0..found.accepted.len()).filter(|&c| found.candidate(c).effect == effect);
        of_effect
            .map(|c| found.accepted[c].variables.clone())
            .collect()
    };
    let (links, joints) = (of(Effect::LinkParameters), of(Effect::FrictionParameters));
    let inside =
        |ranges: &[std::ops::Range<usize>], i: usize| ranges.iter().any(|r| r.contains(&i));
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
            parts.push(Part {
                effect,
                accepted: Some(c),
                torque: only(&|i| accepted.variables.contains(&i)),
            });
        }
    }
    parts
}

/// Shares of what all causes together remove, in mean over joints of squared NRMSE; they sum to one.
fn shapley(gap: &Array2<f64>, parts: &[Part], deviation: &[Option<f64>]) -> Vec<f64> {
    let all: Array2<f64> = parts
        .iter()
        .fold(Array2::zeros(gap.dim()), |sum, p| sum + &p.torque);
    let values: Vec<f64> = parts
        .iter()
        .map(|p| {
            let each = deviation
                .iter()
                .enumerate()
                .filter_map(|(j, d)| Some((j, (*d)?)));
            each.map(|(j, d)| {
                let c = p.torque.column(j);
                (2.0 * gap.column(j).dot(&c) - c.dot(&all.column(j))) / (d * d)
            })
            .sum()
        })
        .collect();
    let sum: f64 = values.iter().map(|v: &f64| v.max(0.0)).sum();
    values
        .iter()
        .map(|v| if sum > 0.0 { v.max(0.0) / sum } else { 0.0 })
        .collect()
}

/// Joints that a cause is reported for: its own, or those whose torque it changes noticeably.
fn touched(
    torque: &Array2<f64>,
    residual: &Array2<f64>,
    part: &Part,
    found: &Findings,
    deviation: &[Option<f64>],
) -> Vec<usize> {
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
    (0..fall.len())
        .filter(|&j| fall[j] >= 0.35 * most || freed(part, found, j))
        .collect()
}

/// The first link or joint whose parameters were accepted as wrong.
fn suspected(found: &Findings, effect: Effect) -> Option<&Accepted> {
    let mut of_effect = (0..found.accepted.len()).filter(|&c| found.candidate(c).effect == effect);
    of_effect.next().map(|c| &found.accepted[c])
}

/// Whether a joint's own friction coefficients were accepted as wrong, however little torque that is.
fn freed(part: &Part, found: &Findings, joint: usize) -> bool {
    part.effect == Effect::FrictionParameters
        && (0..found.accepted.len()).any(|c| {
            let candidate = found.candidate(c);
            candidate.effect == Effect::FrictionParameters
                && candidate.joints == [joint]
                && candidate.quantities.len() > 1
        })
}

/// Part of the joints' squared error that is removed, with a 90 % interval by bootstrap over blocks of time.
fn closed(
    with: &Array2<f64>,
    without: &Array2<f64>,
    joints: &[usize],
    block: usize,
) -> (f64, [f64; 2]) {
    let block = block.max(1);
    let sums: Vec<(f64, f64)> = (0..with.nrows().div_ceil(block))
        .map(|b| {
            let rows = b * block..((b + 1) * block).min(with.nrows());
            let squares = |t: &Array2<f64>| {
                joints
                    .iter()
                    .map(|&j| rows.clone().map(|i| t[[i, j]] * t[[i, j]]).sum::<f64>())
                    .sum::<f64>()
            };
            let before = squares(without);
            (before - squares(with), before)
        })
        .collect();
    signal::bootstrap::ratio(&sums)
}

/// Part of the gap, as given, that the last step removes.
pub fn removed(ladder: &[Step]) -> f64 {
    let (Some(first), Some(last)) = (ladder.first(), ladder.last()) else {
        return 0.0;
    };
    1.0 - total(&last.all) / total(&first.all).max(1e-300)
}
