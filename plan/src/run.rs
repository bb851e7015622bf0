//! The steps of the program.

use crate::arguments::Arguments;
use crate::{limits, motion, torque};
use datasets::write::WriteProblem;
use datasets::{Part, ReadOptions, Recording, read};
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
    let plan = planned(arguments, &options)?;
    let period = motion::period(&plan)?;
    let mut model = loaded(arguments, period)?;
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
    let motion = motion::motion(&plan, file.preprocessing.cutoff_hz)?;
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
    write(arguments, plan, torque)?;
    if !arguments.quiet {
        say!(
            "{}: {} samples, no limit broken",
            arguments.out.display(),
            motion.time.len()
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

/// The plan; references are read as the motion itself where it has nothing else.
fn planned(arguments: &Arguments, options: &ReadOptions) -> Result<Recording, Failure> {
    let path = &arguments.trajectory;
    read(path, options).or_else(|own| {
        let dof = options.dof.unwrap_or_default();
        read(path, &ReadOptions::for_reference(dof))
            .map_err(|_| Failure::input(own.to_string(), ""))
    })
}

/// The model at the period of the plan.
fn loaded(arguments: &Arguments, period: f64) -> Result<Feedforward, Failure> {
    let load = if arguments.physics_only {
        Feedforward::load_physics
    } else {
        Feedforward::load
    };
    load(&arguments.model, Some(period)).map_err(|e| {
        let hint = match &e {
            LoadError::Windows { .. } => {
                "Sample the plan at the period of the controller, or leave the compensator out (--physics-only)."
            }
            _ => "",
        };
        Failure::input(e.to_string(), hint)
    })
}

/// The plan with its torque.
fn write(arguments: &Arguments, mut plan: Recording, torque: Array2<f64>) -> Result<(), Failure> {
    plan.tau = Some(torque);
    plan.torque_filter = None;
    datasets::write(&plan, &arguments.out).map_err(|e| match e.problem {
        WriteProblem::UnknownFormat(_) => Failure::input(e.to_string(), ""),
        _ => Failure::other(e.to_string()),
    })
}
