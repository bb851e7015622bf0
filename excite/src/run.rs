//! The command from arguments to files.

use crate::arguments::{Arguments, Method};
use crate::columns::{extras, usual_noise};
use crate::commands::commands;
use crate::design::{Designed, design};
use crate::judged::{Coverage, conditions, coverage};
use crate::limits::{Given, each, given};
use crate::motion::{Labelled, from_file, sampled};
use crate::plan::plan;
use crate::summary::{Summary, Trajectory};
use crate::{page, screen};
use datasets::write_reference;
use identify::base::BaseParameters;
use identify::excitation::BaseRows;
use identify::least_squares::LeastSquaresError;
use indicatif::ProgressBar;
use model::failure::Failure;
use model::preparation::setup::Setup;
use physics::robot::Robot;
use std::time::Duration;

/// Runs the command `excite`, from arguments to files.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let setup = Setup::with_joints(
        &arguments.robot,
        &arguments.joints,
        arguments.drive.as_deref(),
        arguments.gravity,
    )?;
    let robot = &setup.robot;
    let given = given(robot, arguments)?;
    for (j, limit) in given.limits.iter().enumerate() {
        limit
            .check(j)
            .map_err(|e| crate::failure::of(&e, &robot.joint_names()))?;
    }
    if arguments.replay {
        return for_replay(arguments, &given, &robot.joint_names());
    }
    let noise = match each("--noise", &arguments.noise, robot.dof())? {
        Some(noise) => noise,
        None => usual_noise(robot, &given.limits),
    };
    let spinner = ProgressBar::new_spinner();
    spinner.enable_steady_tick(Duration::from_millis(200));
    spinner.set_message("designing");
    let designed = match &arguments.motion {
        Some(_) => None,
        None => Some(design(robot, &given, &noise, arguments)?),
    };
    let labelled = match (&arguments.motion, &designed) {
        (Some(path), _) => from_file(&setup, path)?,
        (None, Some(d)) => sampled(&d.trajectories, arguments.rate, arguments.repeat),
        (None, None) => unreachable!("a motion is read or designed"),
    };
    let motion = &labelled.motion;
    let extras = extras(&arguments.columns);
    let base = BaseParameters::of_robot(robot, &extras);
    let rows = BaseRows::new(robot, &base, &extras);
    let unjudged = |e: LeastSquaresError| Failure::other(e.to_string());
    let planned = if arguments.plan {
        spinner.set_message("looking what it would show");
        let looked = |done: usize, of: usize| {
            spinner.set_message(format!(
                "looking what it would show: {done} of {of} effects"
            ));
        };
        Some(plan(robot, &base, &extras, motion, &noise, &looked).map_err(unjudged)?)
    } else {
        None
    };
    let joints = coverage(robot, motion, &given.limits);
    let summary = Summary {
        schema: "excitation/1",
        robot: robot.name().to_owned(),
        method: designed.as_ref().map(|_| arguments.method.name()),
        criterion: designed
            .as_ref()
            .filter(|_| arguments.method != Method::ModelFree)
            .map(|_| arguments.criterion.name()),
        seed: designed.as_ref().map(|_| arguments.seed),
        trajectories: trajectories(&labelled, designed.as_ref()),
        evaluations: designed.as_ref().map_or(0, |d| d.evaluations),
        conditions: conditions(&rows, motion, &noise).map_err(unjudged)?,
        notes: notes(robot, arguments, designed.as_ref(), given.assumed, &joints),
        joints,
        noise,
        collisions_checked: false,
        plan: planned,
    };
    spinner.finish_and_clear();
    // Files first: nothing is printed of a run whose files cannot be written.
    if designed.is_some() {
        write(&labelled, arguments)?;
    }
    if let Some(path) = &arguments.json {
        let text = serde_json::to_string_pretty(&summary).expect("numbers and strings");
        report::write_atomic(path, text + "\n")?;
    }
    if let Some(path) = &arguments.html {
        report::write_atomic(path, page::page(&summary, robot, &labelled).render())?;
    }
    if !arguments.quiet {
        screen::say(
            &summary,
            designed.is_some().then_some(arguments.out.as_path()),
        );
    }
    Ok(())
}

/// Commands for a replay, and what each part of them shows.
fn for_replay(arguments: &Arguments, given: &Given, names: &[String]) -> Result<(), Failure> {
    let (labelled, shows) = commands(given, arguments.share, arguments.rate, names)?;
    write(&labelled, arguments)?;
    if arguments.quiet {
        return Ok(());
    }
    for ((label, segment), what) in labelled
        .labels
        .iter()
        .zip(&labelled.motion.segments)
        .zip(shows)
    {
        report::say!(
            "{label}: {:.0} s, {what}",
            segment.len() as f64 / arguments.rate
        );
    }
    report::say!(
        "Record them twice, without and with a known load: `residyn replay --before WITHOUT --data WITH …` finds the load in the scale of the \
         description's masses, and what it should be gives the true scale."
    );
    report::say!("{}", screen::COLLISIONS);
    report::say!("Commands: {}", arguments.out.display());
    Ok(())
}

fn write(labelled: &Labelled, arguments: &Arguments) -> Result<(), Failure> {
    write_reference(&labelled.motion, &labelled.labels, &arguments.out).map_err(|e| {
        let input = matches!(e.problem, datasets::write::WriteProblem::UnknownFormat(_));
        let text = e.to_string();
        if input {
            Failure::input(text, "")
        } else {
            Failure::other(text)
        }
    })
}

fn trajectories(labelled: &Labelled, designed: Option<&Designed>) -> Vec<Trajectory> {
    let motion = &labelled.motion;
    let each = labelled.labels.iter().zip(&motion.segments).enumerate();
    each.map(|(k, (label, s))| {
        let cost = designed.and_then(|d| d.costs.get(k));
        Trajectory {
            label: label.clone(),
            seconds: motion.time[s.end - 1] - motion.time[s.start],
            start: motion.q.row(s.start).to_vec(),
            cost: cost.map(|c| c[0]),
            start_cost: cost.map(|c| c[1]),
        }
    })
    .collect()
}

fn notes(
    robot: &Robot,
    arguments: &Arguments,
    designed: Option<&Designed>,
    assumed: [bool; 2],
    joints: &[Coverage],
) -> Vec<String> {
    let mut notes: Vec<String> = robot.notes().to_vec();
    notes.extend(robot.findings().iter().map(|f| format!("warning: {f}")));
    notes.extend(designed.iter().flat_map(|d| d.notes.clone()));
    if assumed[0] && designed.is_some() {
        notes.push("accelerations are limited to full speed in 0.5 s: no description knows better, --acceleration does".into());
    }
    if assumed[1] && designed.is_some() {
        notes.push("jerks are limited to full acceleration in 0.1 s: --jerk says otherwise".into());
    }
    let over: Vec<&str> = joints
        .iter()
        .filter(|c| c.effort().is_some_and(|e| e > 1.0))
        .map(|c| c.joint.as_str())
        .collect();
    if !over.is_empty() {
        notes.push(format!(
            "by its description the robot needs more torque than it has on {}: a smaller --acceleration, --velocity or --share",
            over.join(", ")
        ));
    }
    if arguments.noise.is_empty() {
        notes.push(
            "torque noise is taken as a hundredth of each joint's torque: --noise says otherwise"
                .into(),
        );
    }
    notes
}
