//! The whole diagnosis of a pair of recordings.

use crate::analysis::{Findings, Frames, find};
use crate::contact::detect;
use crate::effect::Effect;
use crate::error::DiagnoseError;
use crate::explain::{Explanation, explain, removed};
use crate::forward;
use crate::ladder::{repeatability, step};
use crate::learned::learned;
use crate::locate::locate;
use crate::model::NominalModel;
use crate::moved::moved;
use crate::objective::Settings;
use crate::patch::{self, possible};
use crate::recordings::{checked, not_identifiable, notes};
use crate::report::{Cause, Diagnosis, Place, Simulation, Tested, Unexplained, Verdict};
use crate::scene::rigid_torque;
use crate::unknown::{Left, examine};
use datasets::Recording;
use physics::robot::Robot;

/// Structure left on some joint, relative to its torque, from which it counts as clear.
const CLEAR: f64 = 0.03;
/// Part of the whole gap that it must be.
const CLEAR_SHARE: f64 = 0.06;
/// Structured error that is clear whatever its share.
const PLAIN: f64 = 0.09;
/// Part of the gap that the causes must remove to explain it.
const EXPLAINED: f64 = 0.8;
/// Gap on the worst joint below which there is none.
const SMALL: f64 = 0.05;
/// Part of the error that a learner may predict for the rest to count as contact.
const CONTACT_LEARNABLE: f64 = 0.35;
/// Least part of the gap that contact makes.
const CONTACT_SIZE: f64 = 0.1;
/// Time around a burst that is not fitted either, s.
const CONTACT_MARGIN: f64 = 0.1;

/// Everything a report is made of.
pub struct Outcome {
    /// The report.
    pub diagnosis: Diagnosis,
    /// The search behind it.
    pub findings: Findings,
    /// Prepared recordings.
    pub frames: Frames,
    /// The measured explanation.
    pub explanation: Explanation,
    /// What is left per joint, on the fitted recording.
    pub left: Vec<Left>,
}

/// What a diagnosis is to do.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// How gaps are weighed.
    pub settings: Settings,
    /// Train a compensator on what the causes leave.
    pub learn: bool,
    /// Simulate motion with the model as given and with the causes.
    pub simulate: bool,
}

/// Diagnoses the gap between a model and recordings.
///
/// # Errors
/// A recording that cannot be used.
pub fn diagnose(
    model: &NominalModel,
    data: &Recording,
    heldout: &Recording,
    options: &Options,
) -> Result<Outcome, DiagnoseError> {
    let settings = options.settings.clone();
    let frames = Frames::new(model, data, heldout)?;
    let mut weight = frames.data.weights();
    let mut findings = find(model, &frames, &weight, settings.clone())?;
    let mut explanation = explain(model, &frames, &findings, false)?;
    let mut left = examine(&frames.data, &explanation.residual_data);
    let mut cleaned = explanation.residual_data.clone();
    // What a learner predicts from motion repeats, and is no contact.
    let repeats = left
        .iter()
        .any(|l| l.structured() > CLEAR && l.learnable > CONTACT_LEARNABLE);
    if let Some(contact) = detect(&frames.data, &explanation.residual_data).filter(|c| {
        !repeats
            && options.settings.withheld != Some(Effect::ExternalContact)
            && c.size > CONTACT_SIZE * explanation.given_data
    }) {
        let margin = (CONTACT_MARGIN * frames.data.report().rate_hz) as usize;
        for (mut row, hit) in weight
            .rows_mut()
            .into_iter()
            .zip(contact.covers(&frames.data, margin))
        {
            if hit {
                row.fill(0.0);
            }
        }
        findings = find(model, &frames, &weight, settings)?;
        explanation = explain(model, &frames, &findings, true)?;
        let rest = detect(&frames.data, &explanation.residual_data);
        cleaned = rest.map_or_else(
            || explanation.residual_data.clone(),
            |c| &explanation.residual_data - &c.torque,
        );
        left = examine(&frames.data, &cleaned);
    }
    let names = model.robot.joint_names();
    let recordings = checked(model, &frames, [data, heldout]);
    let mut ladder = explanation.ladder.clone();
    if options.learn
        && let Some(torque) = learned(&frames, &cleaned, &findings.present)?
    {
        let rest = &explanation.residual - &torque;
        ladder.push(step("learned", &rest, &frames.heldout));
    }
    ladder.extend(repeatability(heldout, &frames.heldout));
    let simulation = if options.simulate {
        simulated(model, &frames, &findings, &explanation)?
    } else {
        None
    };
    let samples = frames.heldout.samples();
    let load = rigid_torque(&model.robot, &samples.q, &samples.qd, &samples.qdd);
    let diagnosis = Diagnosis {
        schema: "diagnosis/1",
        joints: names.clone(),
        verdict: verdict(&explanation, &left),
        ladder,
        places: places_in_units(
            locate(
                &explanation.gap,
                &frames.heldout.tau,
                &load,
                samples,
                &names,
                frames.heldout.report().rate_hz,
            ),
            &model.robot,
        ),
        causes: in_units(explanation.causes.clone(), &model.robot),
        moved_parameters: moved(model, &findings),
        candidates: tested(&findings, &names),
        not_identifiable: not_identifiable(&frames, recordings.first(), &names),
        recordings,
        simulation,
        next_experiment: None,
        unexplained: names
            .iter()
            .zip(&left)
            .map(|(joint, l)| Unexplained {
                joint: joint.clone(),
                nrmse: l.structured(),
                learnable: l.learnable,
            })
            .collect(),
        notes: notes(&frames),
    };
    Ok(Outcome {
        diagnosis,
        findings,
        frames,
        explanation,
        left,
    })
}

/// Motion with the model as given and with the causes, where its links can be made possible bodies.
fn simulated(
    model: &NominalModel,
    frames: &Frames,
    findings: &Findings,
    explanation: &Explanation,
) -> Result<Option<Simulation>, DiagnoseError> {
    let given = possible::robot(model.sizes(), &model.robot)?;
    let patched = patch::robot(model, findings, &explanation.causes)?;
    let held = &frames.heldout;
    let before = forward::Model {
        robot: &given,
        torque: &(&held.tau - &explanation.gap),
    };
    let after = forward::Model {
        robot: &patched,
        torque: &(&held.tau - &explanation.residual),
    };
    Ok(forward::compare(held, &before, &after))
}

/// Units of joints that slide instead of turning. Inertial parameters are those of links.
fn in_units(mut causes: Vec<Cause>, robot: &Robot) -> Vec<Cause> {
    let slides = |name: &Option<String>| name.as_ref().is_some_and(|n| slides(robot, n));
    for cause in &mut causes {
        if matches!(cause.effect, Effect::LinkParameters | Effect::Payload) {
            continue;
        }
        for p in cause.parameters.iter_mut().filter(|p| slides(&p.joint)) {
            p.unit = linear(&p.unit).unwrap_or(&p.unit).to_owned();
        }
    }
    causes
}

/// The same of regions.
fn places_in_units(mut places: Vec<Place>, robot: &Robot) -> Vec<Place> {
    for place in places.iter_mut().filter(|p| slides(robot, &p.joint)) {
        place.unit = linear(place.unit).unwrap_or(place.unit);
    }
    places
}

fn slides(robot: &Robot, joint: &str) -> bool {
    let mut joints = robot.joints().iter();
    joints.any(|j| j.name == joint && !j.kind.is_rotation())
}

/// What an angular unit becomes where the joint slides.
fn linear(unit: &str) -> Option<&'static str> {
    Some(match unit {
        "N·m" => "N",
        "N·m·s/rad" => "N·s/m",
        "N·m/rad" => "N/m",
        "kg·m²" => "kg",
        "rad" => "m",
        "rad/s" => "m/s",
        "rad/s²" => "m/s²",
        "1/rad" => "1/m",
        _ => return None,
    })
}

fn verdict(explanation: &Explanation, left: &[Left]) -> Verdict {
    let given = explanation.ladder[0]
        .all
        .nrmse
        .iter()
        .flatten()
        .map(|v| v * v)
        .sum::<f64>();
    let clear = left.iter().any(|l| {
        let s = l.structured();
        s > PLAIN || s > CLEAR && s * s > CLEAR_SHARE * given
    });
    if clear {
        return Verdict::UnknownEffect;
    }
    if explanation.causes.is_empty() {
        return if given.sqrt() < SMALL || removed(&explanation.ladder) < EXPLAINED {
            Verdict::NoGap
        } else {
            Verdict::Explained
        };
    }
    let floor = left.iter().all(|l| l.structured() < CLEAR / 2.0);
    let bare = left.iter().all(|l| l.structured() < CLEAR);
    if floor || (bare && removed(&explanation.ladder) > EXPLAINED) {
        Verdict::Explained
    } else {
        Verdict::PartlyExplained
    }
}

/// The best candidate of each effect and place beyond the accepted causes.
fn tested(findings: &Findings, names: &[String]) -> Vec<Tested> {
    const MOST: usize = 40;
    let mut seen: Vec<(Effect, Vec<usize>, Option<usize>)> = Vec::new();
    let mut out = Vec::new();
    for t in findings
        .accepted
        .iter()
        .flat_map(|a| &a.tried)
        .chain(&findings.rest)
    {
        let c = &findings.candidates[t.candidate];
        let key = (c.effect, c.joints.clone(), c.driver);
        if seen.contains(&key) || out.len() >= MOST {
            continue;
        }
        seen.push(key);
        let given: f64 = c.joints.iter().map(|&j| findings.grams.total[j].yy).sum();
        let now: f64 = c.joints.iter().map(|&j| t.error[j]).sum();
        out.push(Tested {
            effect: c.effect,
            joints: c.joints.iter().map(|&j| names[j].clone()).collect(),
            gap_closed: 1.0 - now / given.max(1e-300),
            p_value: (-t.gain.max(0.0)).exp(),
        });
    }
    out
}
