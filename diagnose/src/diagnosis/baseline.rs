//! Baseline from a robot's own earlier recordings: residuals and gains where nothing has changed.
//!
//! Each part of the earlier recordings is diagnosed against the model of the others, as a later recording is
//! against all. The findings are the model's own misfit on unknown motions, and a change must exceed them.

use super::earlier::{Baseline, Earlier};
use super::options::Options;
use super::searched::{Channels, Searched, Searcher};
use crate::catalogue::choice::Choice;
use crate::error::DiagnoseError;
use crate::input::before;
use crate::input::frames::Frames;
use crate::motion::standing::State;
use crate::settings::Settings;
use crate::simulator::{NominalModel, Replay};
use crate::traces::unknown::Misfit;
use datasets::{Folds, Recording, repeats};
use physics::robot::Robot;
use rayon::prelude::*;

/// Number of parts of the earlier recordings.
const PARTS: usize = 3;
/// Part of the later recording's time in repeated motions from which torque is compared with torque.
const REPEATED: f64 = 0.5;

/// Options of a diagnosis against earlier recordings, joined, and the model identified from them.
pub(crate) fn options(
    model: &NominalModel,
    before: &Recording,
    after: &Recording,
    cutoff_hz: Option<f64>,
) -> Options {
    let (share, executions) = model.replay().map_or((0.0, 0.0), |r| r.known(after));
    if share >= REPEATED {
        let spread = spread(&[before, after]);
        return changes(Earlier::Repeated {
            executions,
            single: spread.is_none(),
            usual: spread.unwrap_or_else(|| of_fit(model, Replay::deviation)),
        });
    }
    let usual = usual(model, before, cutoff_hz, &changes(Earlier::Other(None)));
    changes(Earlier::Other(usual))
}

/// Repeatability of the robot: the spread of torque between executions of one motion within a recording, which are
/// trajectories or periods. The larger one of the two recordings counts. None where no motion is repeated.
fn spread(recordings: &[&Recording]) -> Option<Baseline> {
    let each = recordings.iter().filter_map(|r| {
        let left = repeats::spread(r)?;
        let tau = r.tau.as_ref()?;
        let structured = left.iter().zip(tau.columns()).map(|(left, tau)| {
            let size = tau.std(0.0);
            if size > 0.0 { left / size } else { 0.0 }
        });
        Some(Baseline {
            earned: 0.0,
            structured: structured.collect(),
            left,
        })
    });
    each.reduce(Baseline::most)
}

/// Options for a search for changes: the links are unchanged, and the robot's own model has narrower tolerances
/// than a description. No confidence is given, since it was calibrated on descriptions.
fn changes(earlier: Earlier) -> Options {
    let mut settings = Settings::default();
    let search = &mut settings.search;
    search.inertial_tolerance = match earlier {
        Earlier::Repeated { .. } => search.inertial_repeated,
        Earlier::Other(_) => search.inertial_of_own,
    };
    search.friction_tolerance = search.friction_of_own;
    settings.measure.confidence.weights = None;
    Options {
        settings,
        effects: Choice::Changes,
        earlier: Some(earlier),
        ..Options::default()
    }
}

/// Baseline from earlier recordings, joined, and the model identified from them. None where they are one
/// trajectory, or where no part of them suffices to identify a model.
fn usual(
    model: &NominalModel,
    before: &Recording,
    cutoff_hz: Option<f64>,
    options: &Options,
) -> Option<Baseline> {
    let groups = Folds::of_visits(&[before], PARTS).of_trajectories(&[before]);
    let parts: Vec<Vec<usize>> = (0..PARTS)
        .map(|part| {
            let own = groups[0].iter().enumerate();
            own.filter(|(_, g)| **g == part).map(|(i, _)| i).collect()
        })
        .filter(|part: &Vec<usize>| !part.is_empty() && part.len() < before.trajectories.len())
        .collect();
    let each: Vec<Baseline> = parts
        .par_iter()
        .filter_map(|part| of_part(model.sizes(), before, part, cutoff_hz, options).ok())
        .collect();
    // The residual of a part may be smaller than that of the whole.
    let own = of_fit(model, Replay::left);
    each.into_iter().reduce(Baseline::most).map(|u| u.most(own))
}

fn of_part(
    robot: &Robot,
    before: &Recording,
    part: &[usize],
    cutoff_hz: Option<f64>,
    options: &Options,
) -> Result<Baseline, DiagnoseError> {
    let (others, own) = before.split(part);
    let model = before::model(robot, &[others], cutoff_hz)?;
    let model = model.alone().on_clock_of(&[&own])?;
    let settings = &options.settings;
    let mut frames = Frames::new(&model, &own, &own, cutoff_hz, &settings.input)?;
    let channels = Channels::new(&frames, settings);
    let (found, _) = super::first(&model, &mut frames, &channels, None, options)?;
    let searcher = Searcher::new(&model, &frames, &channels, options);
    let Searched {
        findings,
        left,
        judged,
        ..
    } = searcher.searched(found)?;
    let rows = frames.data.len() as f64;
    let judged = judged.off_turns(&frames.data, &options.settings.motion);
    let moving = |j: usize| {
        let both = judged.gap.column(j).into_iter().zip(judged.state.column(j));
        let squares = both
            .filter(|(_, s)| **s == State::Moving)
            .map(|(g, _)| g * g);
        let (sum, n) = squares.fold((0.0, 0.0), |(sum, n), x| (sum + x, n + 1.0));
        f64::sqrt(sum / f64::max(n, 1.0))
    };
    Ok(Baseline {
        earned: findings.most_earned() / rows,
        left: (0..robot.dof()).map(moving).collect(),
        structured: left
            .iter()
            .map(|l| l.as_ref().map_or(0.0, Misfit::structured))
            .collect(),
    })
}

/// Baseline of the recordings that the model was identified from: `left` of the residual there. Its structured part
/// is seen in parts of the recordings alone.
fn of_fit(model: &NominalModel, left: impl Fn(&Replay) -> Vec<f64>) -> Baseline {
    let left = model.replay().map_or_else(Vec::new, left);
    Baseline {
        earned: 0.0,
        structured: vec![0.0; left.len()],
        left,
    }
}
