//! The steps of the program.

use crate::arguments::Arguments;
use crate::unit::Convention;
use crate::{jump, limits, motion, torque};
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
use std::path::Path;

/// Reads, computes, checks, writes.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let file = ModelFile::load(&arguments.model)?;
    let options = read_options(&file, arguments.drive.as_deref(), Part::Test, false)?;
    let Planned { plan, written } = planned(arguments, &options)?;
    let (mut model, sampled) = loaded(arguments, motion::period(&plan))?;
    let robot = model.dynamics().robot().clone();
    let drive = match &arguments.drive {
        Some(path) => {
            Some(Drive::from_file(path, &robot).map_err(|e| Failure::input(e.to_string(), ""))?)
        }
        None => None,
    };
    let convention = if written.is_some() {
        Convention::Drive
    } else {
        Convention::Joint
    };
    let divisors = arguments.unit.divisors(drive.as_ref(), &robot, convention).map_err(|e| {
        Failure::input(
            e.to_string(),
            "Give gear_ratio, torque_constant and for per_mille rated_current in a drive file (--drive FILE.toml).",
        )
    })?;
    let waypoints = motion::motion(&plan)?;
    let motion = if sampled {
        waypoints.clone()
    } else {
        motion::between(&waypoints, model.period())?
    };
    let (mut torque, outside) = torque::along(&mut model, &motion);
    if let Some(broken) = limits::broken(&robot, &motion, &torque) {
        let file = &plan.source;
        if broken.by_speed
            && let Some(jump) = jump::largest(&plan, &robot)
        {
            let advice =
                "Mend that row, or give what follows another label in the column `trajectory`.";
            return Err(Failure::input(format!("{file}: {jump}; {broken}"), advice));
        }
        let advice = limits::advice(&broken, &mut model, &motion);
        return Err(Failure::input(format!("{file}: {broken}"), advice));
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
    let table = written.unwrap_or(plan);
    write(arguments, table, torque, &robot.joint_names())?;
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
        for (joint, outside) in robot.joints().iter().zip(outside) {
            if let Some(outside) = outside {
                say!(
                    "  {}: {outside} of {} samples",
                    joint.name,
                    motion.time.len()
                );
            }
        }
    }
    Ok(())
}

/// A plan as it is computed with and as it is written.
struct Planned {
    /// In SI units, in the convention of the joints.
    plan: Recording,
    /// The table's own numbers, in the units and signs of the drive file; none where messages are read or written, which are
    /// in SI units in the convention of the joints.
    written: Option<Recording>,
}

/// Hint for a table of few rows.
const FEW: &str = "Sample the plan more densely; a bag with a trajectory_msgs/JointTrajectory may hold waypoints that are few and far apart.";

/// Reads the plan. References are read as the motion itself where a table has nothing else. Times of messages count from
/// their start.
fn planned(arguments: &Arguments, options: &ReadOptions) -> Result<Planned, Failure> {
    let path = &arguments.trajectory;
    let fail = |e: datasets::ReadError| match &e.problem {
        Problem::TooShort { .. } => {
            Failure::input(format!("{}: {}", e.file.display(), e.problem), FEW)
        }
        _ => Failure::input(e.to_string(), ""),
    };
    if matches!(read::Format::of(path), Ok(read::Format::Bag))
        && let Some(plan) = read::planned_trajectories(path, &options.joints).map_err(fail)?
    {
        return Ok(Planned {
            plan,
            written: None,
        });
    }
    let mut reference = ReadOptions {
        joints: options.joints.clone(),
        stored_model: options.stored_model,
        ..ReadOptions::for_reference(options.dof.unwrap_or_default())
    };
    reference.columns.units.clone_from(&options.columns.units);
    reference.columns.time_scale = options.columns.time_scale;
    let (plan, mut own) = match read(path, options) {
        Ok(plan) => (plan, options.clone()),
        Err(error) => match read(path, &reference) {
            Ok(plan) => (plan, reference),
            Err(e) if matches!(e.problem, Problem::WrongDof { .. }) => return Err(fail(e)),
            Err(_) => return Err(fail(error)),
        },
    };
    own.columns.units.clear();
    let written = if is_message(&arguments.out) {
        None
    } else {
        let mut written = read(path, &own).map_err(fail)?;
        if let Some(scale) = own.columns.time_scale {
            written.time.iter_mut().for_each(|t| *t /= scale);
        }
        Some(written)
    };
    Ok(Planned { plan, written })
}

/// Whether a file of this name holds JointTrajectory messages.
fn is_message(path: &Path) -> bool {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    ["mcap", "yaml", "yml"].contains(&ending.to_ascii_lowercase().as_str())
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
    torque: Array2<f64>,
    joints: &[String],
) -> Result<(), Failure> {
    plan.tau = Some(torque);
    plan.torque_filter = None;
    let out = &arguments.out;
    let written = if is_message(out) {
        // Times of a message count from its start.
        for t in &plan.trajectories {
            let first = plan.time[t.range.start];
            plan.time[t.range.clone()]
                .iter_mut()
                .for_each(|t| *t -= first);
        }
        datasets::write::write_trajectories(&plan, joints, out)
    } else {
        datasets::write(&plan, out)
    };
    written.map_err(|e| match &e.problem {
        WriteProblem::UnknownFormat(ending) => Failure::input(
            format!("{} cannot be written as `{ending}`", out.display()),
            "Use .csv or .parquet for a table, .mcap or .yaml for a JointTrajectory.",
        ),
        _ => Failure::other(e.to_string()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use datasets::{Affine, Group};

    /// A table of degrees, whose second joint has the other sign and another zero than the description.
    #[test]
    fn a_table_is_computed_in_radians_and_written_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let degree = 1.0_f64.to_radians();
        let conversion = [[degree, 0.0], [-degree, 0.5]];
        let conversion = conversion.map(|[scale, offset]| Affine { scale, offset });
        let mut options = ReadOptions {
            torque_needed: false,
            ..ReadOptions::for_robot(2)
        };
        options.columns.units.insert(Group::Q, conversion.to_vec());
        options.columns.time_scale = Some(1e-3);
        for name in ["q", "q_ref"] {
            let file = folder.path().join(format!("{name}.csv"));
            let rows = (0..30).map(|k| format!("{},{k},{}\n", 10 * k, 2 * k));
            let text = format!("time,{name}1,{name}2\n{}", rows.collect::<String>());
            std::fs::write(&file, text).unwrap();
            let of = |out: &str| {
                let file = file.to_str().unwrap();
                let words = [
                    "feedforward",
                    "--model",
                    "m",
                    "--trajectory",
                    file,
                    "--out",
                    out,
                ];
                planned(&Arguments::parse_from(words), &options).unwrap()
            };
            let Planned { plan, written } = of("out.csv");
            let written = written.unwrap();
            assert!((written.time[20] - 200.0).abs() < 1e-9 && (plan.time[20] - 0.2).abs() < 1e-12);
            assert_eq!([written.q[[20, 0]], written.q[[20, 1]]], [20.0, 40.0]);
            assert!((plan.q[[20, 0]] - 20.0 * degree).abs() < 1e-12);
            assert!((plan.q[[20, 1]] - (0.5 - 40.0 * degree)).abs() < 1e-12);
            // Messages are in radians, in the signs of the description.
            assert!(of("out.yaml").written.is_none());
        }
    }
}
