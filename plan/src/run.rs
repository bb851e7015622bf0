//! The steps of the program.

use crate::arguments::Arguments;
use crate::{limits, motion, torque};
use datasets::read::{self, read};
use datasets::write::WriteProblem;
use datasets::{Part, Problem, ReadOptions, Recording};
use feedforward::{Feedforward, LoadError};
use model::directory::ModelFile;
use model::evaluation::read_options;
use model::failure::Failure;
use ndarray::Array2;
use physics::robot::drive::Drive;
use report::say;

/// Reads, computes, checks, writes.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let file = ModelFile::load(&arguments.model)?;
    let options = read_options(&file, arguments.drive.as_deref(), Part::Test, false)?;
    let (plan, is_message) = planned(arguments, &options)?;
    let (mut model, sampled) = loaded(arguments, motion::period(&plan))?;
    let robot = model.dynamics().robot().clone();
    let drive = match &arguments.drive {
        Some(path) => {
            Some(Drive::from_file(path, &robot).map_err(|e| Failure::input(e.to_string(), ""))?)
        }
        None => None,
    };
    let divisors = arguments.unit.divisors(drive.as_ref(), &robot).map_err(|e| {
        Failure::input(
            e.to_string(),
            "Give gear_ratio, torque_constant and for per_mille rated_current in a drive file (--drive FILE.toml).",
        )
    })?;
    let waypoints = motion::motion(&plan, file.preprocessing.cutoff_hz)?;
    let motion = if sampled {
        waypoints.clone()
    } else {
        motion::between(&waypoints, model.period())?
    };
    let mut torque = torque::along(&mut model, &motion);
    if let Some(broken) = limits::broken(&robot, &motion, &torque) {
        let advice = limits::advice(&broken, &mut model, &motion);
        return Err(Failure::input(format!("{}: {broken}", plan.source), advice));
    }
    let peaks: Vec<f64> = torque
        .columns()
        .into_iter()
        .map(|c| c.iter().fold(0.0, |peak: f64, t| peak.max(t.abs())))
        .collect();
    for (mut column, divisor) in torque.columns_mut().into_iter().zip(&divisors) {
        column /= *divisor;
    }
    if !sampled {
        torque = motion::at_waypoints(&torque, &motion, &waypoints);
    }
    write(arguments, plan, is_message, torque, &robot.joint_names())?;
    if !arguments.quiet {
        say!(
            "{}: {} samples, no limit broken",
            arguments.out.display(),
            waypoints.time.len()
        );
        for (joint, peak) in robot.joints().iter().zip(peaks) {
            say!(
                "  {}: at most {peak:.2} of {:.2} N·m (N)",
                joint.name,
                joint.limits.effort
            );
        }
    }
    Ok(())
}

/// The plan, and whether it is of JointTrajectory messages, whose times count from their start. References are read
/// as the motion itself where a table has nothing else.
fn planned(arguments: &Arguments, options: &ReadOptions) -> Result<(Recording, bool), Failure> {
    let path = &arguments.trajectory;
    let fail = |e: datasets::ReadError| Failure::input(e.to_string(), "");
    if matches!(read::Format::of(path), Ok(read::Format::Bag))
        && let Some(plan) = read::planned_trajectories(path, &options.joints).map_err(fail)?
    {
        return Ok((plan, true));
    }
    let table = read(path, options).or_else(|own| {
        let reference = ReadOptions {
            joints: options.joints.clone(),
            stored_model: options.stored_model,
            ..ReadOptions::for_reference(options.dof.unwrap_or_default())
        };
        read(path, &reference).map_err(|e| match &e.problem {
            Problem::WrongDof { .. } => fail(e),
            _ => fail(own),
        })
    })?;
    Ok((table, false))
}

/// The model at the `period` of the plan, s, where the compensator runs at that; else at the period of its training. Beside it
/// whether the plan is sampled at the model's period.
fn loaded(arguments: &Arguments, period: Option<f64>) -> Result<(Feedforward, bool), Failure> {
    let load = if arguments.physics_only {
        Feedforward::load_physics
    } else {
        Feedforward::load
    };
    let own = period.map(|p| load(&arguments.model, Some(p)));
    let loaded = match own {
        None | Some(Err(LoadError::Windows { .. })) => {
            load(&arguments.model, None).map(|m| (m, false))
        }
        Some(own) => own.map(|m| (m, true)),
    };
    loaded.map_err(|e| Failure::input(e.to_string(), ""))
}

/// The plan with its torque: a table, or messages that a joint_trajectory_controller takes.
fn write(
    arguments: &Arguments,
    mut plan: Recording,
    is_message: bool,
    torque: Array2<f64>,
    joints: &[String],
) -> Result<(), Failure> {
    plan.tau = Some(torque);
    plan.torque_filter = None;
    let out = &arguments.out;
    let ending = out.extension().and_then(|e| e.to_str()).unwrap_or("");
    let written = if ["mcap", "yaml", "yml"].contains(&ending.to_ascii_lowercase().as_str()) {
        if !is_message {
            for t in &plan.trajectories {
                let first = plan.time[t.range.start];
                plan.time[t.range.clone()]
                    .iter_mut()
                    .for_each(|t| *t -= first);
            }
        }
        datasets::write::write_trajectories(&plan, joints, out)
    } else {
        datasets::write(&plan, out)
    };
    written.map_err(|e| match e.problem {
        WriteProblem::UnknownFormat(_) => Failure::input(e.to_string(), ""),
        _ => Failure::other(e.to_string()),
    })
}
