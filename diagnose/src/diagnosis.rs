//! The whole diagnosis of a pair of recordings.

pub use crate::outcome::Outcome;

use crate::advice::patch;
use crate::catalogue::effect::Effect;
use crate::error::DiagnoseError;
use crate::input::frames::Frames;
use crate::input::recordings::{checked, not_identifiable, notes};
use crate::ladder::listing::{Listing, list};
use crate::ladder::scores::{Scored, repeatability, total};
use crate::measure::bounds::hold;
use crate::measure::explain::{Explanation, Said, explain};
use crate::measure::follow;
use crate::measure::friction::friction;
use crate::measure::learned::learned;
use crate::measure::locate::locate;
use crate::measure::moved::moved;
use crate::measure::resonance::{resonances, standing_out};
use crate::measure::verdict::{Evidence, dead, moves, remainder, verdict};
use crate::motion::floor::floor;
use crate::motion::rigid::rigid_torque;
use crate::motion::scene::Scene;
use crate::motion::standing::{Coulomb, Judged, judge, states};
use crate::schema::{Cause, Diagnosis, NotIdentifiable, Place, Simulation, Tested};
use crate::search::find::{Findings, find};
use crate::settings::Settings;
use crate::simulator::{NominalModel, possible};
use crate::surrogates::{self, Null};
use crate::traces::contact::{Contact, detect, suspected};
use crate::traces::unknown::{Left, examine};
use datasets::Recording;
use datasets::metrics::Scope;
use ndarray::Array2;
use physics::robot::Robot;

/// What a diagnosis is to do.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// How gaps are weighed.
    pub settings: Settings,
    /// Effect that is left out of the catalogue, for the proof.
    pub withheld: Option<Effect>,
    /// Cut-off of the motion's low-pass, Hz; chosen from the fitted recording where none is given.
    pub cutoff_hz: Option<f64>,
    /// Train a compensator on what the causes leave.
    pub learn: bool,
    /// Simulate motion with the model as given and with the causes.
    pub simulate: bool,
    /// Surrogates of the recording that chance is told by; none are drawn for zero.
    pub surrogates: u64,
}

/// What the fitted recording says, some of its samples left out.
struct Search {
    findings: Findings,
    listing: Listing,
    left: Vec<Option<Left>>,
    judged: Judged,
    /// Torque that the links need at the recorded samples, shape (samples, joints).
    load: Array2<f64>,
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
    let settings = &options.settings;
    let (pushes, judging) = (&settings.traces.contact, &settings.measure.verdict);
    let frames = Frames::new(model, data, heldout, options.cutoff_hz, &settings.input)?;
    let dead = dead(&frames.data, judging);
    let states = states(&frames.data, &settings.motion);
    let moves = moves(&frames.data, &states, &dead, judging);
    let mut weight = frames.data.weights(&settings.motion);
    for (mut column, _) in weight.columns_mut().into_iter().zip(&dead).filter(|d| *d.1) {
        column.fill(0.0);
    }
    let search =
        |weight: &Array2<f64>, skipped: &[bool], chance: f64| -> Result<Search, DiagnoseError> {
            let (own, withheld) = (settings.clone(), options.withheld);
            let mut findings = find(model, &frames, weight, own, withheld, chance)?;
            let scored = Scored::new(&dead, skipped.iter().map(|s| !s).collect());
            let listing = list(model, &frames, &mut findings, weight, &scored, moves);
            let left = examine(
                &frames.data,
                &listing.residual,
                &frames.data.pick(|i| skipped[i]),
                settings,
            );
            let scene = Scene::new(&findings.present, frames.passage(), &frames.scale);
            let load = frames.data.table_to_samples(&scene.rigid);
            let coulomb = Coulomb {
                torque: listing.coulomb.clone(),
                sign: frames.data.table_to_samples(&scene.sign),
            };
            let judged = judge(&frames.data, &listing.residual, &coulomb, &settings.motion);
            Ok(Search {
                findings,
                listing,
                left,
                judged,
                load,
            })
        };
    let mut skipped = vec![false; frames.data.tau.nrows()];
    let mut found = search(&weight, &skipped, 0.0)?;
    // What a learner predicts from motion repeats, and is no contact.
    let repeats = |left: &[Option<Left>]| {
        let mut left = left.iter().flatten();
        left.any(|l| l.structured() > judging.clear && l.learnable > pushes.learnable)
    };
    let look = (options.withheld != Some(Effect::ExternalContact)).then(|| !repeats(&found.left));
    let whole = Scored::new(&dead, vec![true; skipped.len()]);
    let pushed = |found: &Search, moving: bool| {
        let rest = whole.figures(&found.listing.residual, &frames.data, Scope::All);
        let least = pushes.least(found.listing.given, total(&rest));
        detect(&frames.data, &found.judged, &found.load, moving, pushes)
            .filter(|c| c.at_rest || c.size > least)
    };
    let without = |weight: &Array2<f64>, out: &[bool]| {
        let mut weight = weight.clone();
        let rows = weight.rows_mut().into_iter();
        let near = rows.zip(frames.data.pick(|i| out[i]));
        near.filter(|r| r.1).for_each(|(mut row, _)| row.fill(0.0));
        weight
    };
    let mut contact = look.and_then(|moving| pushed(&found, moving));
    let unknown = |left: &[Option<Left>]| {
        let mut left = left.iter().flatten();
        left.any(|l| l.structured() > judging.clear)
    };
    // A push on few trajectories bends the fit until nothing stands out any more.
    if contact.is_none() && look == Some(true) && unknown(&found.left) {
        let suspected = suspected(&frames.data, &found.judged, pushes.suspected);
        let clean = search(&without(&weight, &suspected), &suspected, 0.0)?;
        contact = pushed(&clean, true);
    }
    let margin = (pushes.margin * frames.data.report().rate_hz) as usize;
    // Without the pushes the fit shows the rest of them: what is said has been cut.
    let mut near = contact.as_ref().map(|c| c.pushed(skipped.len(), margin));
    while let Some(cut) = near.take() {
        let first = skipped.iter().all(|s| !s);
        skipped.iter_mut().zip(cut).for_each(|(s, n)| *s |= n);
        found = search(&without(&weight, &skipped), &skipped, 0.0)?;
        let more = |c: &Contact| contact.as_ref().is_some_and(|known| c.size > known.size);
        if first && let Some(all) = pushed(&found, !repeats(&found.left)).filter(more) {
            near = Some(all.pushed(skipped.len(), margin));
            contact = Some(all);
        }
    }
    let weight = without(&weight, &skipped);
    let mut drawn = (options.surrogates > 0 && moves).then(|| {
        surrogates::with(model, &frames, &found.findings, &weight, |source| {
            let null = source.null(0..options.surrogates);
            let stand = found.findings.least_earned() > null.level();
            let namings = stand.then(|| source.namings(&found.findings));
            (null, namings)
        })
    });
    // What chance earns as well on this recording is no cause.
    if let Some((null, namings @ None)) = &mut drawn {
        found = search(&weight, &skipped, null.level())?;
        // Where a cause is left beside parameters, it has to be named again.
        *namings = found.findings.least_earned().is_finite().then(|| {
            surrogates::with(model, &frames, &found.findings, &weight, |source| {
                source.namings(&found.findings)
            })
        });
    }
    let (null, namings) = drawn.unzip();
    let namings = namings.flatten().unwrap_or_default();
    let null = null.as_ref();
    let bounds = hold(model, &mut found.findings, &frames.scale);
    let said = Said {
        listing: &found.listing,
        contact: contact.as_ref(),
        dead: &dead,
        null,
        namings: &namings,
        left: &found.left,
        look: look.map(|_| !repeats(&found.left)),
    };
    let explanation = explain(model, &frames, &found.findings, &said);
    let names = model.robot.joint_names();
    let state = &found.judged.state;
    let floors = floor(&model.robot, data, &frames.data, state, &settings.motion);
    let (judged, left) = (&found.judged, &found.left);
    let rest = remainder(&floors, judged, &skipped, left, &names, &dead, judging);
    let evidence = Evidence {
        dead: &dead,
        moves,
        given: found.listing.given,
        left: &found.left,
        rest: &rest,
        causes: !explanation.causes.is_empty(),
        pushed: explanation
            .causes
            .iter()
            .any(|c| c.effect == Effect::ExternalContact),
        cut: explanation.cut,
    };
    let (verdict, reason) = verdict(&evidence, judging);
    let Search {
        findings,
        listing,
        left,
        ..
    } = found;
    let mut quiet = listing.residual;
    for (mut row, _) in quiet.rows_mut().into_iter().zip(&skipped).filter(|r| *r.1) {
        row.fill(0.0);
    }
    let recordings = checked(model, &frames, [data, heldout]);
    let mut ladder = explanation.ladder.clone();
    let learned = if options.learn {
        learned(&frames, &quiet, &findings.present, &settings.measure.said)?
    } else {
        None
    };
    if let Some(learned) = &learned {
        let rest = &explanation.residual - &learned.torque;
        let scored = &explanation.scored;
        ladder.push(scored.step("learned", &rest, &frames.heldout));
    }
    ladder.extend(repeatability(heldout, &frames.heldout));
    let simulation = if options.simulate {
        simulated(model, &frames, &findings, &explanation)?
    } else {
        None
    };
    let samples = frames.heldout.samples();
    let load = rigid_torque(&model.robot, &samples.q, &samples.qd, &samples.qdd);
    let mut unknowable = not_identifiable(&frames, recordings.first(), &names, &settings.input);
    unknowable.extend(
        names
            .iter()
            .zip(&dead)
            .filter(|(_, dead)| **dead)
            .map(|(name, _)| NotIdentifiable {
                effect: None,
                joints: vec![name.clone()],
                reason: format!(
                    "{name} has no usable torque channel: nearly every sample has one value"
                ),
            }),
    );
    let diagnosis = Diagnosis {
        schema: "diagnosis/1",
        joints: names.clone(),
        verdict,
        reason,
        ladder,
        places: places_in_units(
            locate(
                &explanation.gap,
                &frames.heldout.tau,
                &load,
                samples,
                &names,
                frames.heldout.report().rate_hz,
                settings,
            ),
            &model.robot,
        ),
        causes: in_units(explanation.causes.clone(), &model.robot),
        resonances: resonances(
            &frames.data,
            &standing_out(model, &frames, &findings),
            &names,
            &settings.measure.resonance,
        ),
        friction: friction(model, &frames, &findings),
        moved_parameters: moved(model, &findings),
        bounds,
        candidates: tested(&findings, &names, null),
        not_identifiable: unknowable,
        recordings,
        simulation,
        next_experiment: None,
        unexplained: rest,
        notes: notes(&frames, &settings.input),
    };
    Ok(Outcome {
        diagnosis,
        findings,
        frames,
        explanation,
        learned,
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
    let before = follow::Model {
        robot: &given,
        torque: &(&held.tau - &explanation.gap),
    };
    let after = follow::Model {
        robot: &patched,
        torque: &(&held.tau - &explanation.residual),
    };
    Ok(follow::compare(held, &before, &after))
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

/// The best candidate of each effect and place beyond the accepted causes.
fn tested(findings: &Findings, names: &[String], null: Option<&Null>) -> Vec<Tested> {
    let most = findings.settings.measure.said.candidates;
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
        if seen.contains(&key) || out.len() >= most {
            continue;
        }
        seen.push(key);
        let given: f64 = c.joints.iter().map(|&j| findings.grams.total[j].yy).sum();
        let now: f64 = c.joints.iter().map(|&j| t.error[j]).sum();
        out.push(Tested {
            effect: c.effect,
            joints: c.joints.iter().map(|&j| names[j].clone()).collect(),
            gap_closed: 1.0 - now / given.max(1e-300),
            p_value: null.and_then(|n| n.p_value(c.effect, findings.earned(t))),
        });
    }
    out
}
