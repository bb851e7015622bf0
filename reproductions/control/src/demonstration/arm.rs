//! The simulated robot of a model directory.
//!
//! A model of COMAU Smart-3 S2 joints under its PID, and its model-based control, belong beside this file: a [`Trial`] with a
//! [`Subject`] of that robot.

use super::experiment::Demonstration;
use super::trial::Trial;
use crate::ControlError;
use crate::measures::Settle;
use crate::model::DirectoryModel;
use crate::motion::{Fourier, Motion, arm};
use crate::subject::Subject;
use crate::track::Settings;
use ::model::directory::ModelFile;
use identify::excitation::MotionLimits;
use physics::dynamics::{Workspace, mass_matrix};
use physics::robot::Builtin;
use plant::reference::Command;
use std::f64::consts::TAU;
use std::path::Path;
use trials::Protocol;
use trials::protocols::{Gear, Machine};

/// What the robot has that a rigid model with viscous and Coulomb friction lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Withheld {
    /// Friction with memory, load and temperature, ripple, as in the protocol's recordings, and elastic gears, which no
    /// recording of a protocol has.
    #[default]
    FrictionAndElasticity,
    /// The same with stiff gears: the robot of the protocol's recordings.
    Friction,
    /// Nothing: the robot of `simulate … --plain`.
    Nothing,
}

/// Crossover of the velocity loop, Hz: below half the frequency at which an elastic gear's link stands against its motor.
const CROSSOVER: f64 = 5.0;
/// That frequency of every joint with all others held, Hz, and the gear's damping ratio.
const ANTIRESONANCE: f64 = 12.0;
const DAMPING: f64 = 0.05;
/// Least inertia behind an elastic gear relative to the rotor's: the KR300's last link is a point on its joint's axis in its
/// description, so that nothing would swing behind that gear.
const CARRIED: f64 = 1e-3;

/// Length of the Fourier motion, s; part of the joints' room and of their speeds that it uses; its acceleration over its speed, 1/s.
const PERIOD: f64 = 10.0;
const SHARE: f64 = 0.7;
const LIVELINESS: f64 = 5.0;

/// PESETTLE, degrees (the manual's for the Delta), and TIMESETTLE, s.
const PESETTLE: f64 = 0.05;
const TIMESETTLE: f64 = 0.01;

/// Runs the simulated robot that a model directory belongs to.
///
/// # Errors
/// A directory of a robot of which there is no simulated one, or that cannot be used.
pub fn of_directory(
    directory: &Path,
    file: &ModelFile,
    withheld: Withheld,
    seed: u64,
) -> Result<Demonstration, ControlError> {
    let machine = machine(file, withheld)?;
    let settings = Settings {
        crossover_hz: CROSSOVER,
        ..Settings::default()
    };
    let mut model = DirectoryModel::load(directory, file, settings.period())?;
    let time = model.start().unwrap_or(0.0);
    let robot = machine.arm.robot()?;
    let n = robot.dof();
    let tool = |q: &[f64]| arm::tool(&robot, q);
    let fourier = Fourier::draw(limits(&machine), PERIOD, seed)?;
    let mut motions: Vec<(String, Box<dyn Motion>)> = Vec::new();
    let mut notes = vec![match withheld {
        Withheld::FrictionAndElasticity => format!(
            "The simulated robot has friction with memory, load, temperature and ripple, and elastic gears ({ANTIRESONANCE} Hz with the \
             motor held), of which the model was told nothing but what its recordings showed; those were made with stiff gears."
        ),
        Withheld::Friction => "The simulated robot has friction with memory, load, temperature and ripple, of which the model was told \
             nothing but what its recordings showed."
            .to_owned(),
        Withheld::Nothing => "The simulated robot has viscous and Coulomb friction and stiff gears.".to_owned(),
    }];
    match arm::line(&robot, &machine.arm.centre) {
        Some((line, length)) => {
            let words = format!("tool on a line of {:.0} mm", 1e3 * length);
            motions.push((words, Box::new(line)));
        }
        None => notes
            .push("No line: the arm cannot follow one from the middle of its region.".to_owned()),
    }
    let words = format!("Fourier series of {PERIOD} s, seed {seed}");
    motions.push((words, Box::new(fourier)));
    let mut experiments = Vec::new();
    for (words, motion) in &motions {
        let mut begin = Command::new(n);
        motion.at(0.0, &mut begin);
        let trial = Trial {
            robot: machine.arm.family,
            motion: motion.as_ref(),
            words: words.clone(),
            tool: Some(&tool),
            settle: Some(Settle {
                pesettle: vec![PESETTLE.to_radians(); n],
                timesettle: TIMESETTLE,
            }),
            from: 0.0,
            settings: settings.clone(),
        };
        experiments.push(trial.run(|| Subject::arm(&machine, &begin.q, time), &mut model)?);
    }
    Ok(Demonstration {
        schema: "closed-loop/1",
        experiments,
        notes,
    })
}

/// The simulated robot of a model.
///
/// # Errors
/// A robot without a protocol.
pub fn machine(file: &ModelFile, withheld: Withheld) -> Result<Machine, ControlError> {
    let protocol = match file.physics.builtin {
        Some(Builtin::Ur5) => Protocol::Ur5,
        Some(Builtin::Kr300) => Protocol::Kr300,
        Some(Builtin::FoxbotA05) => Protocol::FoxbotA05,
        _ => {
            let known = Protocol::ALL.map(Protocol::name).join(", ");
            return Err(ControlError::NoSubject(file.physics.robot.clone(), known));
        }
    };
    let machine = protocol.machine()?;
    match withheld {
        Withheld::Nothing => return Ok(machine.plain()),
        Withheld::Friction => return Ok(machine),
        Withheld::FrictionAndElasticity => {}
    }
    let robot = machine.arm.robot()?;
    let n = robot.dof();
    let mut mass = vec![0.0; n * n];
    mass_matrix(
        &robot,
        &mut Workspace::new(&robot),
        &machine.arm.centre,
        &mut mass,
    );
    let w = TAU * ANTIRESONANCE;
    let gears = (0..n).map(|j| {
        let inertia = mass[j * n + j];
        (inertia > CARRIED * robot.joints()[j].rotor_inertia).then_some(Gear {
            stiffness: inertia * w * w,
            damping: 2.0 * DAMPING * inertia * w,
        })
    });
    Ok(Machine {
        gears: gears.collect(),
        ..machine
    })
}

/// The room of a Fourier motion.
pub fn limits(machine: &Machine) -> Vec<MotionLimits> {
    let arm = &machine.arm;
    let each = arm.joints.iter().zip(arm.centre.iter().zip(&arm.reach));
    each.map(|(joint, (centre, reach))| {
        let velocity = SHARE * joint.limits.velocity;
        MotionLimits {
            lower: centre - SHARE * reach,
            upper: centre + SHARE * reach,
            velocity,
            acceleration: LIVELINESS * velocity,
            jerk: f64::INFINITY,
        }
    })
    .collect()
}
