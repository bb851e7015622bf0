//! Effect of each cause on the held-out recording: steps of the ladder, shares, intervals, sizes.

use crate::algebra::fit::Fit;
use crate::catalogue::Candidate;
use crate::catalogue::effect::Effect;
use crate::input::frames::Frames;
use crate::ladder::listing::Listing;
use crate::ladder::rungs::Free;
use crate::ladder::scores::{Scored, total};
use crate::measure::by_cause::{Added, by_cause, together};
use crate::measure::quantities::{ambiguous, lead, moved, parameters, pushed, rubbing};
use crate::measure::shares::{Removed, closed, normed};
use crate::motion::scene::Scene;
use crate::motion::standing::{Coulomb, judge};
use crate::schema::{Cause, SHORT, STRUCK, Step, Support};
use crate::search::find::{Accepted, Columns, Findings, gap};
use crate::simulator::NominalModel;
use crate::surrogates::Null;
use crate::traces::contact::{Contact, detect};
use crate::traces::unknown::Misfit;
use datasets::metrics::Scope;
use datasets::metrics::deviations;
use ndarray::{Array1, Array2};
use physics::robot::PARAMETERS_PER_LINK;

/// Torque of one cause on the held-out recording, shape (samples, joints).
struct Part {
    effect: Effect,
    accepted: Option<usize>,
    torque: Array2<f64>,
}

/// Ladder, causes, and the residual of the last step on the held-out recording.
pub struct Explanation {
    /// Steps of the ladder on the held-out recording.
    pub ladder: Vec<Step>,
    /// The same way with the causes first: as given, one step per cause in their order, then the other parameters.
    pub by_cause: Vec<Step>,
    /// Causes, largest share first.
    pub causes: Vec<Cause>,
    /// Held-out gap as given, shape (samples, joints); zero where a joint is not judged.
    pub gap: Array2<f64>,
    /// Held-out residual of the last step, shape (samples, joints), with pushes still in it.
    pub residual: Array2<f64>,
    /// Joints and samples of the held-out recording that are scored at the last step.
    pub scored: Scored,
    /// Part of the held-out samples that pushes cut out.
    pub cut: f64,
}

/// Findings on the fitted recording, which the held-out recording only measures.
pub struct FittedFindings<'a> {
    /// Causes that are listed in the report.
    pub listing: &'a Listing,
    /// Pushes found in the fitted recording.
    pub contact: Option<&'a Contact>,
    /// Whether each joint of the fitted recording lacks a usable torque channel.
    pub dead: &'a [bool],
    /// Chance level of gains from surrogates, where they were drawn.
    pub null: Option<&'a Null>,
    /// Structure in the residual of each joint beside the causes.
    pub left: &'a [Option<Misfit>],
    /// Search for pushes in the held-out recording: none where it is off, else whether joints in motion are searched, too.
    pub look: Option<bool>,
}

/// Measures the findings on the held-out recording. Its torque chooses nothing but the pushes that are found in it.
pub fn explain(
    model: &NominalModel,
    frames: &Frames,
    found: &Findings,
    said: &FittedFindings,
) -> Explanation {
    let (held, settings) = (&frames.heldout, &found.settings);
    let names = model.robot.joint_names();
    let whole = Scored::new(said.dead, vec![true; held.tau.nrows()]);
    let judged = |table: Array2<f64>| whole.judged(table);
    let gap_held = judged(gap(model, held, &frames.scale));
    let mut deviation = deviations(held.tau.view(), held.samples().qd.view());
    if deviation.iter().all(Option::is_none) {
        // A robot at rest has no NRMSE; its joints' shares are relative to what they hold.
        let spread = held.tau.columns().into_iter().map(|c| c.std(0.0));
        deviation = spread.map(|s| Some(s).filter(|s| *s > 0.0)).collect();
    }
    let scene = Scene::new(
        &found.session.present,
        frames.heldout_passage(),
        &frames.scale,
    );
    let columns = Columns::new(&found.dictionary, &scene, held, &found.tight.0);
    let shape = gap_held.dim();
    let left = |causes: &[usize], free: Free| {
        let fit: Fit = found.refit(model, &frames.scale, causes, free);
        judged(&gap_held - &columns.torque(shape, &fit.variables, fit.beta()))
    };
    let structure = found.structure();
    let as_given = judged(gap(model, held, &frames.scale.at_once()));
    let mut ladder = vec![whole.step("as_given", &as_given, held)];
    let mut residual = left(&[], Free::All);
    ladder.push(whole.step("reidentified", &residual, held));
    for n in 1..=structure.len() {
        residual = left(&structure[..n], Free::All);
        let name = found.candidate(structure[n - 1]).effect.name();
        ladder.push(whole.step(name, &residual, held));
    }
    let mut parts = parts(model, found, &columns, shape);
    parts.iter_mut().for_each(|p| {
        let torque = std::mem::take(&mut p.torque);
        p.torque = judged(torque);
    });
    let here = said.look.and_then(|moving| {
        let coulomb = Coulomb {
            torque: said.listing.coulomb.clone(),
            sign: held.table_to_samples(&scene.sign),
        };
        let rest = total(&whole.figures(&residual, held, Scope::All));
        let least = settings.traces.contact.least(total(&ladder[0].all), rest);
        let judged = judge(held, &residual, &coulomb, &settings.motion);
        let load = held.table_to_samples(&scene.rigid);
        detect(held, &judged, &load, moving, &settings.traces.contact)
            .filter(|c| c.at_rest || c.size > least)
    });
    let cut = here
        .as_ref()
        .map_or_else(|| vec![false; shape.0], |c| c.pushed(shape.0, 0));
    let scored = Scored::new(said.dead, cut.iter().map(|c| !c).collect());
    // What of a residual is scored.
    let kept = |residual: &Array2<f64>| {
        let mut kept = residual.clone();
        let rows = kept.rows_mut().into_iter().zip(&cut);
        rows.filter(|(_, c)| **c)
            .for_each(|(mut row, _)| row.fill(0.0));
        kept
    };
    if here.is_some() || said.contact.is_some() {
        ladder.push(scored.step(Effect::ExternalContact.name(), &residual, held));
        parts.push(Part {
            effect: Effect::ExternalContact,
            accepted: None,
            torque: &residual - &kept(&residual),
        });
    }
    let all: Array2<f64> = parts
        .iter()
        .fold(Array2::zeros(shape), |sum, p| sum + &p.torque);
    let tight_residual = &gap_held - &all;
    let listed = |p: &Part| {
        !p.effect.info().parameter || said.listing.parameters.iter().any(|l| l.0 == p.effect)
    };
    let block = (settings.ladder.stretch * held.report().rate_hz) as usize;
    let short = frames.data.is_short(&settings.ladder);
    let mut causes = Vec::new();
    let mut values = Vec::new();
    let mut added = Vec::new();
    for part in parts.iter().filter(|p| listed(p)) {
        let contact = part.effect.info().outside;
        let mut joints = joints(part, said, here.as_ref());
        if part.accepted.is_none() && part.effect.info().friction {
            joints = rubbing(model, found, joints);
        }
        let (with, without) = match part.accepted {
            _ if contact => (kept(&residual), residual.clone()),
            Some(_) if part.effect.info().absorbable => {
                (tight_residual.clone(), &tight_residual + &part.torque)
            }
            Some(c) => {
                let others: Vec<usize> = structure.iter().copied().filter(|&o| o != c).collect();
                (residual.clone(), left(&others, Free::All))
            }
            None => {
                let friction = part.effect.info().friction;
                let held_fast = if friction {
                    Free::Links
                } else {
                    Free::Friction
                };
                (residual.clone(), left(&structure, held_fast))
            }
        };
        let with = if contact { with } else { kept(&with) };
        let without = if contact { without } else { kept(&without) };
        let (closed, interval) = closed(&with, &without, &joints, block);
        let sizes = match part.accepted {
            Some(c) => parameters(found, c, &names),
            None if contact => pushed(model, frames, said.contact, here.as_ref()),
            None => moved(model, found, part.effect, &joints, &names),
        };
        // Links of which no parameter moved, and which help nowhere but in the fitted recording, leave nothing to set.
        let nothing = part.effect == Effect::LinkParameters && sizes.is_empty();
        if nothing && interval[0] <= 0.0 && suspected(found, part.effect).is_none() {
            continue;
        }
        let alone = match part.accepted.filter(|_| part.effect.info().absorbable) {
            Some(c) => {
                let fit = found.tight_without(c, &frames.scale);
                let torque = columns.torque(shape, &fit.variables, fit.beta());
                kept(&judged(&gap_held - &torque))
            }
            None => without,
        };
        let removed = Removed {
            gap: &gap_held,
            all: &all,
            torque: &part.torque,
            with: &with,
            without: &alone,
        };
        values.push(removed.value(&deviation));
        added.push(Added::by(part.effect, part.accepted));
        let cause = part.accepted.map(|c| &found.accepted[c]);
        // Of a trace that names by itself, and of a few seconds, nobody has counted how often a name is right.
        let judged = |c: &usize| found.candidate(*c).shown.is_none() && !short;
        let support = part.accepted.filter(judged);
        let support = support.and_then(|c| Support::new(found, &found.accepted[c], said.left));
        let pushes = if contact {
            let data = said
                .contact
                .map(|c| c.pushes("data", &model.robot, &frames.data));
            let here = here
                .as_ref()
                .map(|c| c.pushes("heldout", &model.robot, held));
            data.into_iter().chain(here).flatten().collect()
        } else {
            Vec::new()
        };
        causes.push(Cause {
            effect: part.effect,
            kind: if part.effect.info().parameter {
                "parameter"
            } else {
                "structure"
            },
            joints: joints.iter().map(|&j| names[j].clone()).collect(),
            driver: part
                .accepted
                .and_then(|c| found.candidate(c).driver)
                .map(|d| names[d].clone()),
            confidence: support.and_then(|s| s.confidence(&settings.measure.confidence)),
            support,
            lead: cause.map(|a| lead(found, &a.tried, a.candidate)),
            share_of_gap: 0.0,
            gap_closed: closed,
            // Pushes do not repeat: of what another recording would show they say nothing.
            gap_closed_interval: Some(interval).filter(|_| !contact),
            confirmed: if contact {
                here.is_some()
            } else {
                interval[0] > 0.0
            },
            p_value: cause.and_then(|a| chance(found, a, said.null)),
            parameters: sizes,
            pushes,
            ambiguous_with: cause
                .or_else(|| suspected(found, part.effect))
                .map_or_else(Vec::new, |a| ambiguous(found, &a.tried, a.candidate)),
            right_to: cause
                .and_then(|a| a.against.within)
                .map(|factor| factor * settings.search.inertial_tolerance),
            remark: remark(short, part.accepted.map(|c| found.candidate(c))),
        });
    }
    for (cause, share) in causes.iter_mut().zip(normed(&values)) {
        cause.share_of_gap = share;
    }
    let mut causes: Vec<(Cause, Added)> = causes.into_iter().zip(added).collect();
    causes.sort_by(|(a, _), (b, _)| b.share_of_gap.total_cmp(&a.share_of_gap));
    let step = |name: &str, added: &[Added]| {
        let (structure, free, cut) = together(added);
        let scored = if cut { &scored } else { &whole };
        scored.step(name, &left(&structure, free), held)
    };
    let by_cause = by_cause(&ladder, &causes, step);
    let causes: Vec<Cause> = causes.into_iter().map(|(cause, _)| cause).collect();
    let lost = cut.iter().filter(|c| **c).count();
    Explanation {
        ladder,
        by_cause,
        causes,
        gap: gap_held,
        residual,
        scored,
        cut: lost as f64 / shape.0.max(1) as f64,
    }
}

/// Caveat of a cause for the report.
fn remark(short: bool, candidate: Option<&Candidate>) -> Option<&'static str> {
    let shown = candidate.and_then(|c| c.shown).map(|_| STRUCK);
    short.then_some(SHORT).or(shown)
}

/// Probability of such a gain, or such a trace, where no effect is present.
fn chance(found: &Findings, cause: &Accepted, null: Option<&Null>) -> Option<f64> {
    if let Some(shown) = found.candidates[cause.candidate].shown {
        return null.map(|_| shown);
    }
    let mut tried = cause.tried.iter();
    let own = tried.find(|t| t.candidate == cause.candidate)?;
    null?.p_value(found.candidates[own.candidate].effect, found.earned(own))
}

/// Joints that a cause is reported for.
fn joints(part: &Part, said: &FittedFindings, here: Option<&Contact>) -> Vec<usize> {
    match part.accepted {
        Some(cause) => {
            let mut listed = said.listing.structure.iter();
            listed
                .find(|(c, _)| *c == cause)
                .map_or_else(Vec::new, |l| l.1.clone())
        }
        None if part.effect.info().parameter => {
            let mut listed = said.listing.parameters.iter();
            listed
                .find(|(e, _)| *e == part.effect)
                .map_or_else(Vec::new, |l| l.1.clone())
        }
        None => {
            let all = here.into_iter().chain(said.contact);
            let mut joints: Vec<usize> = all.flat_map(Contact::loaded).collect();
            joints.sort_unstable();
            joints.dedup();
            joints
        }
    }
}

/// Torques of all causes from the joint fit near the given parameters, shape (samples, joints) each.
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
        if !effect.info().parameter {
            parts.push(Part {
                effect,
                accepted: Some(c),
                torque: only(&|i| accepted.variables.contains(&i)),
            });
        }
    }
    parts
}

/// The first link or joint whose parameters were accepted as wrong.
fn suspected(found: &Findings, effect: Effect) -> Option<&Accepted> {
    let mut of_effect = (0..found.accepted.len()).filter(|&c| found.candidate(c).effect == effect);
    of_effect.next().map(|c| &found.accepted[c])
}
