//! The whole diagnosis of a pair of recordings.

mod autocorrelation;
mod baseline;
mod earlier;
mod options;
mod reversal_weights;
mod searched;
mod sensors;
mod torque_delay;
mod units;

pub use crate::outcome::Outcome;
pub(crate) use baseline::options as since;
use earlier::following;
pub use earlier::{Baseline, Earlier};
pub use options::Options;

use crate::advice::patch;
use crate::catalogue::effect::Effect;
use crate::error::DiagnoseError;
use crate::input::frames::Frames;
use crate::input::recordings::{checked, not_identifiable, notes};
use crate::ladder::scores::repeatability;
use crate::measure::bounds::hold;
use crate::measure::changed_parameters::moved;
use crate::measure::explain::{Explanation, FittedFindings, explain};
use crate::measure::friction::friction;
use crate::measure::learned::learned;
use crate::measure::locate::locate;
use crate::measure::other_day;
use crate::measure::resonance::{resonances, standing_out};
use crate::measure::tracking;
use crate::measure::verdict::{Evidence, remainder, verdict};
use crate::motion::floor::floor;
use crate::schema::{Cause, Diagnosis, Place, Simulation, Step, Tested, Verdict};
use crate::search::find::Findings;
use crate::search::session::Session;
use crate::settings::Settings;
use crate::simulator::{NominalModel, possible};
use crate::surrogates::Null;
use crate::traces::unknown::by_chance;
use datasets::Recording;
use physics::batch::rigid_torque;
use physics::robot::{Masses, Robot};
use searched::{Channels, Searched, Searcher};
use std::sync::Arc;

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
    let input = &options.settings.input;
    let frames = Frames::new(model, data, heldout, options.cutoff_hz, input)?;
    Ok(diagnosed(model, [data, heldout], frames, None, options)?.0)
}

/// A pair of recordings, prepared once for several diagnoses by one model whose options differ in the special
/// rules of the search alone.
pub struct Prepared<'a> {
    model: &'a NominalModel,
    recordings: [&'a Recording; 2],
    frames: Frames,
    session: Arc<Session>,
}

impl<'a> Prepared<'a> {
    /// Diagnoses a pair, fitted recording first, and keeps what further diagnoses of it share.
    ///
    /// # Errors
    /// A recording that cannot be used.
    pub fn new(
        model: &'a NominalModel,
        recordings: [&'a Recording; 2],
        options: &Options,
    ) -> Result<(Self, Outcome), DiagnoseError> {
        let [data, heldout] = recordings;
        let input = &options.settings.input;
        let frames = Frames::new(model, data, heldout, options.cutoff_hz, input)?;
        let (outcome, session) = diagnosed(model, recordings, frames.clone(), None, options)?;
        let prepared = Self {
            model,
            recordings,
            frames,
            session,
        };
        Ok((prepared, outcome))
    }

    /// One further diagnosis of the pair.
    ///
    /// # Errors
    /// None beyond those of the model's own numbers.
    pub fn diagnose(&self, options: &Options) -> Result<Outcome, DiagnoseError> {
        let (frames, session) = (self.frames.clone(), Arc::clone(&self.session));
        Ok(diagnosed(self.model, self.recordings, frames, Some(session), options)?.0)
    }
}

/// Diagnoses prepared recordings. `session` is that of the first search of another diagnosis of the same pair, as
/// it is returned beside the outcome.
fn diagnosed(
    model: &NominalModel,
    [data, heldout]: [&Recording; 2],
    mut frames: Frames,
    session: Option<Arc<Session>>,
    options: &Options,
) -> Result<(Outcome, Arc<Session>), DiagnoseError> {
    let settings = &options.settings;
    let channels = Channels::new(&frames, settings);
    let (first, session) = first(model, &mut frames, &channels, session, options)?;
    let Searched {
        mut findings,
        listing,
        left,
        beside,
        judged,
        contact,
        look,
        skipped,
        null,
    } = Searcher::new(model, &frames, &channels, options).searched(first)?;
    let bounds = hold(model, &mut findings, &frames.scale);
    let said = FittedFindings {
        listing: &listing,
        contact: contact.as_ref(),
        dead: &channels.dead,
        null: null.as_ref(),
        left: &left,
        // What a few seconds say goes no further than their motion: beyond it everything departs.
        look: look.filter(|_| !frames.data.is_short(&settings.ladder)),
    };
    let explanation = explain(model, &frames, &findings, &said);
    let names = model.robot.joint_names();
    let floors = floor(
        &model.robot,
        data,
        &frames.data,
        &judged.state,
        &settings.motion,
    );
    let judging = &settings.measure.verdict;
    let (floors, mut left, mut beside) = match &options.earlier {
        Some(earlier) => {
            let [left, beside] = [left, beside].map(|l| earlier.beyond(l, judging.beyond));
            (earlier.floors(floors), left, beside)
        }
        None => (floors, left, beside),
    };
    let usual = options.earlier.as_ref().is_some_and(|earlier| {
        let given = explanation.ladder.first();
        given.is_some_and(|step| earlier.is_usual(&step.all.rmse, &floors, judging.at_floor))
    });
    // Two executions differ by as much as one from its model: only what follows the motion, or is confirmed, counts.
    let doubtful = usual && options.earlier.as_ref().is_some_and(Earlier::is_single);
    if doubtful {
        let rows = frames.data.pick(|i| skipped[i]);
        let chance = by_chance(&frames.data, &listing.residual, &rows, settings);
        [left, beside] = [left, beside].map(|l| following(l, &chance));
    }
    let counted = explanation.causes.iter();
    let counted: Vec<&Cause> = counted.filter(|c| c.confirmed || !doubtful).collect();
    let dead = &channels.dead;
    let judged = judged.off_turns(&frames.data, &settings.motion);
    let rest = remainder(&floors, &judged, &skipped, &left, &names, dead, judging);
    let pushed = |c: &Cause| c.effect.info().outside;
    let evidence = Evidence {
        dead,
        moves: channels.moves,
        given: listing.given,
        left: &beside,
        rest: &rest,
        causes: !counted.is_empty(),
        pushed: counted.into_iter().any(pushed),
        usual: doubtful,
        cut: explanation.cut,
        denied: denied(&explanation.ladder, &explanation.causes),
    };
    let (verdict, reason) = if usual && !doubtful {
        (Verdict::NoGap, None)
    } else {
        verdict(&evidence, judging)
    };
    let unchanged = usual && verdict == Verdict::NoGap;
    let rest_of = &listing.residual;
    let other = other_day::changed(model, &frames, &findings, &explanation, rest_of, &skipped);
    let mut quiet = listing.residual;
    for (mut row, _) in quiet.rows_mut().into_iter().zip(&skipped).filter(|r| *r.1) {
        row.fill(0.0);
    }
    let recordings = checked(model, &frames, [data, heldout]);
    let mut ladder = explanation.ladder.clone();
    let learned = if options.learn {
        learned(
            &frames,
            &quiet,
            &findings.session.present,
            &settings.measure.said,
        )?
    } else {
        None
    };
    if let Some(learned) = &learned {
        let rest = &explanation.residual - &learned.torque;
        let scored = &explanation.scored;
        ladder.push(scored.step("learned", &rest, &frames.heldout));
    }
    ladder.extend(repeatability(heldout, &frames.heldout));
    let parts = patch::parts(model, &findings, &frames.scale, &explanation.causes)?;
    let simulation = if options.simulate {
        simulated(model, &frames, &explanation, &parts.whole)?
    } else {
        None
    };
    let mut unknowable =
        not_identifiable(&frames, recordings.first(), &model.robot, &settings.input);
    unknowable.extend(channels.unusable(&names));
    let mut moved_parameters = moved(model, &findings);
    let causes = if unchanged {
        Vec::new()
    } else {
        let mut causes = explanation.causes.clone();
        let said = &settings.measure.said;
        parts.told(&model.robot, said, &mut causes, &mut moved_parameters);
        units::of_causes(causes, &model.robot)
    };
    let sensors = sensors::beside(&frames, &findings.session.links, &causes, &model.robot);
    let done = notes(&frames, &settings.input, &settings.ladder).into_iter();
    let diagnosis = Diagnosis {
        schema: "diagnosis/1",
        joints: names.clone(),
        verdict,
        reason,
        compared: None,
        no_gap_as_given: match model.robot.masses() {
            _ if model.is_identified() => None,
            Masses::Described => None,
            Masses::Missing => Some("the description has no masses"),
            Masses::Placeholders => Some("the description's masses are placeholders"),
        },
        ladder,
        by_cause: explanation.by_cause.clone(),
        places: places(model, &frames, &explanation, settings),
        causes,
        resonances: resonances(
            &frames.data,
            &standing_out(model, &frames, &findings),
            &names,
            &settings.measure.resonance,
        ),
        friction: friction(model, &frames, &findings),
        moved_parameters,
        bounds,
        candidates: tested(&findings, &names, null.as_ref()),
        not_identifiable: unknowable,
        recordings,
        simulation,
        next_experiment: None,
        unexplained: rest,
        notes: done
            .chain(other_day::note(&other, &names))
            .chain(sensors.iter().cloned())
            .collect(),
    };
    let outcome = Outcome {
        diagnosis,
        findings,
        frames,
        explanation,
        learned,
        left,
        sensors,
    };
    Ok((outcome, session))
}

/// Findings of the first search, with the frames adjusted to its residual: delay of the torque, number of
/// independent samples, and weights of rows near reversals. The search is repeated until the delay is stable.
/// Beside them the session of its first round.
fn first(
    model: &NominalModel,
    frames: &mut Frames,
    channels: &Channels,
    session: Option<Arc<Session>>,
    options: &Options,
) -> Result<(Findings, Arc<Session>), DiagnoseError> {
    let searcher = Searcher::new(model, frames, channels, options);
    let mut first = searcher.first(session)?;
    let prepared = Arc::clone(&first.session);
    for _ in 0..torque_delay::ROUNDS {
        let known = frames.scale.channel.as_deref();
        let said = torque_delay::channel(&first, &model.robot);
        if frames.scale.correlation_rows.is_some() && torque_delay::alike(known, said.as_ref()) {
            break;
        }
        let searcher = Searcher::new(model, frames, channels, options);
        let left = searcher.left(&first);
        // Columns that are to be late are others.
        let on_time = known.is_none() && said.is_none();
        let session = if on_time {
            Searcher::known(&first)
        } else {
            None
        };
        drop(first);
        frames.apply_delay(model, said, left, &options.settings.input);
        first = Searcher::new(model, frames, channels, options).first(session)?;
    }
    Ok((first, prepared))
}

/// Errors on the held-out recording, as given and with all causes, where it confirms no cause and they make it no smaller.
fn denied(ladder: &[Step], causes: &[Cause]) -> Option<[f64; 2]> {
    let of = |step: Option<&Step>| step.and_then(|s| s.all.mean_nrmse);
    let both = [of(ladder.first())?, of(ladder.last())?];
    let open = causes.iter().all(|c| !c.confirmed);
    (open && both[1] >= both[0]).then_some(both)
}

/// The first search of a diagnosis: recordings, findings and the rows' weights.
#[cfg(test)]
pub(crate) fn first_search(
    model: &NominalModel,
    [data, heldout]: [&Recording; 2],
    options: &Options,
) -> Result<(Frames, Findings, ndarray::Array2<f64>), DiagnoseError> {
    let settings = &options.settings;
    let mut frames = Frames::new(model, data, heldout, options.cutoff_hz, &settings.input)?;
    let channels = Channels::new(&frames, settings);
    let (found, _) = first(model, &mut frames, &channels, None, options)?;
    let weight = Searcher::new(model, &frames, &channels, options).weight;
    Ok((frames, found, weight))
}

/// Regions of the held-out recording where the gap lies.
fn places(
    model: &NominalModel,
    frames: &Frames,
    explanation: &Explanation,
    settings: &Settings,
) -> Vec<Place> {
    let (robot, held) = (&model.robot, &frames.heldout);
    let samples = held.samples();
    let load = rigid_torque(robot, &samples.q, &samples.qd, &samples.qdd);
    let places = locate(
        &explanation.gap,
        &held.tau,
        &load,
        samples,
        &robot.joint_names(),
        held.report().rate_hz,
        settings,
    );
    units::of_places(places, robot)
}

/// Simulated motion with the model as given and with the causes, where its links can be made possible bodies.
fn simulated(
    model: &NominalModel,
    frames: &Frames,
    explanation: &Explanation,
    patched: &Robot,
) -> Result<Option<Simulation>, DiagnoseError> {
    let given = possible::robot(model.sizes(), &model.robot)?;
    let held = &frames.heldout;
    let before = tracking::Model {
        robot: &given,
        torque: &(&held.tau - &explanation.gap),
    };
    let after = tracking::Model {
        robot: patched,
        torque: &(&held.tau - &explanation.residual),
    };
    Ok(tracking::compare(held, &before, &after))
}

/// Best candidate of each effect and place that was tried in the place of an accepted cause, or beside all of
/// them. In turns: the first of each list, then the second.
fn tested(findings: &Findings, names: &[String], null: Option<&Null>) -> Vec<Tested> {
    let most = findings.settings.measure.said.candidates;
    let mut seen: Vec<(Effect, Vec<usize>, Option<usize>)> = Vec::new();
    let mut out = Vec::new();
    let lists = findings.accepted.iter().map(|a| &a.tried);
    let lists: Vec<_> = lists.chain([&findings.rest]).collect();
    let longest = lists.iter().map(|l| l.len()).max().unwrap_or(0);
    for t in (0..longest).flat_map(|k| lists.iter().filter_map(move |l| l.get(k))) {
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
