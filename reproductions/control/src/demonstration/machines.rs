//! The softMC manual's demonstration of tracking: SCARA, Delta, PUMA.
//!
//! Its text holds the lines, their speeds, PESETTLE of two of them, and what was found; accelerations, TIMESETTLE, amplitude and
//! frequency of the sine wave, gains and robots it does not. Those here were chosen before anything was run.

use super::experiment::{Compared, Demonstration, Experiment};
use super::trial::Trial;
use crate::ControlError;
use crate::measures::Settle;
use crate::model::IdentifiedMachine;
use crate::motion::{Line, Motion, Profile, Sine};
use crate::subject::Subject;
use crate::track::{Mode, Settings};
use ::machines::description::{Description, Moves};
use ::machines::models::delta::Shape;
use ::machines::plant::SCARA_ARMS;
use nalgebra::Vector3;
use plant::reference::Command;
use std::f64::consts::FRAC_PI_2;

/// Time for which a robot has to be within PESETTLE, s; the manual's value is not in our copy.
const TIMESETTLE: f64 = 0.01;

/// SCARA, Delta and PUMA.
///
/// # Errors
/// A built-in machine that cannot be simulated.
pub fn standard() -> Result<Demonstration, ControlError> {
    let jobs: [fn() -> Result<Experiment, ControlError>; 3] = [scara, delta, puma];
    let experiments = jobs
        .into_iter()
        .map(|job| job())
        .collect::<Result<Vec<_>, _>>()?;
    let notes = vec![
        "Published: softMC manual, section on tracking improvements, real robots whose models, gains, accelerations and TIMESETTLE our \
         copy of the text does not hold. Direction and ratio can be compared, sizes cannot: nothing here was tuned to them."
            .to_owned(),
        "Simulated machines by other equations than the models; each model was identified from a recording of the described sine waves \
         with 1 % torque noise."
            .to_owned(),
        format!(
            "PESETTLE is taken in the manual's user units, degrees and millimetres, on every axis; TIMESETTLE {:.0} ms.",
            1e3 * TIMESETTLE
        ),
    ];
    Ok(Demonstration {
        schema: "closed-loop/1",
        experiments,
        notes,
    })
}

/// PESETTLE in degrees and millimetres.
fn settle(description: &Description, pesettle: f64) -> Settle {
    let unit = |moves| match moves {
        Moves::Rotary => pesettle.to_radians(),
        Moves::Linear => 1e-3 * pesettle,
    };
    Settle {
        pesettle: description.axis.iter().map(|a| unit(a.kind)).collect(),
        timesettle: TIMESETTLE,
    }
}

/// Where a motion starts.
fn start(motion: &dyn Motion, axes: usize) -> Vec<f64> {
    let mut command = Command::new(axes);
    motion.at(0.0, &mut command);
    command.q
}

/// Settling without and with a dynamic model, ms.
fn settling(experiment: &Experiment, published: [f64; 2]) -> Compared {
    let ms = |mode| Some(1e3 * experiment.outcome(mode)?.tracking.settling?);
    Compared {
        figure: "settling time / ms",
        published,
        ours: [ms(Mode::Cascade), ms(Mode::Physics)],
    }
}

fn scara() -> Result<Experiment, ControlError> {
    let description = Description::load("scara4")?;
    let [first, second] = SCARA_ARMS;
    let profile = Profile::new(0.6, 0.9, 9.0, 0.05);
    let line = Line::new(0.6, profile, |way| {
        let (x, y) = (0.35, way - 0.3);
        let cos = (x * x + y * y - first * first - second * second) / (2.0 * first * second);
        let elbow = (cos.abs() <= 1.0).then(|| cos.acos())?;
        let shoulder =
            f64::atan2(y, x) - f64::atan2(second * elbow.sin(), first + second * elbow.cos());
        // The tool keeps its direction.
        Some(vec![shoulder, elbow, 0.075, -shoulder - elbow])
    });
    let line = line.ok_or_else(|| ControlError::OutOfReach(description.name.clone()))?;
    let tool = |q: &[f64]| {
        let (s1, c1) = q[0].sin_cos();
        let (s2, c2) = (q[0] + q[1]).sin_cos();
        Some(Vector3::new(
            first * c1 + second * c2,
            first * s1 + second * s2,
            q[2],
        ))
    };
    let begin = start(&line, 4);
    let trial = Trial {
        robot: "SCARA (scara4)",
        motion: &line,
        words: "line of 600 mm at 900 mm/s, 9 m/s², S-curve over 50 ms".to_owned(),
        tool: Some(&tool),
        settle: Some(settle(&description, 0.001)),
        from: 0.0,
        settings: Settings::default(),
    };
    let mut model = IdentifiedMachine::of(&description)?;
    let mut made = trial.run(|| Subject::machine(&description, &begin), &mut model)?;
    made.published = Some(settling(&made, [300.0, 260.0]));
    Ok(made)
}

fn delta() -> Result<Experiment, ControlError> {
    let description = Description::load("delta3")?;
    let geometry = &description.geometry;
    let length = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let shape = Shape {
        offset: length(geometry.base_radius) - length(geometry.plate_radius),
        arm: length(geometry.arm),
        forearm: length(geometry.forearm),
    };
    let profile = Profile::new(0.55, 3.0, 60.0, 0.02);
    let line = Line::new(0.55, profile, |way| {
        let angles = shape.angles(Vector3::new(way - 0.275, 0.0, -0.75))?;
        Some(angles.to_vec())
    });
    let line = line.ok_or_else(|| ControlError::OutOfReach(description.name.clone()))?;
    let tool = |q: &[f64]| shape.pose([q[0], q[1], q[2]]).map(|pose| pose.plate);
    let begin = start(&line, 3);
    let trial = Trial {
        robot: "Delta (delta3)",
        motion: &line,
        words: "line of 550 mm at 3000 mm/s, 60 m/s², S-curve over 20 ms".to_owned(),
        tool: Some(&tool),
        settle: Some(settle(&description, 0.05)),
        from: 0.0,
        settings: Settings {
            after: 0.5,
            ..Settings::default()
        },
    };
    let mut model = IdentifiedMachine::of(&description)?;
    let mut made = trial.run(|| Subject::machine(&description, &begin), &mut model)?;
    made.published = Some(settling(&made, [268.0, 44.0]));
    Ok(made)
}

fn puma() -> Result<Experiment, ControlError> {
    let description = Description::load("puma560")?;
    let sine = Sine {
        start: vec![0.0, 0.0, -FRAC_PI_2, 0.0, 0.0, 0.0],
        axis: 2,
        swing: 60.0_f64.to_radians(),
        frequency: 0.5,
        periods: 4,
    };
    let begin = sine.start.clone();
    let trial = Trial {
        robot: "PUMA (puma560)",
        motion: &sine,
        words: "axis 3 on a sine wave of 60° at 0.5 Hz, the others at rest; scored from the second period on".to_owned(),
        tool: None,
        settle: None,
        from: 1.0 / sine.frequency,
        settings: Settings {
            after: 0.0,
            ..Settings::default()
        },
    };
    let mut model = IdentifiedMachine::of(&description)?;
    let mut made = trial.run(|| Subject::machine(&description, &begin), &mut model)?;
    let of = |mode| Some(made.outcome(mode)?.tracking.joints[1].peak_to_peak);
    made.published = Some(Compared {
        figure: "axis 2, peak-to-peak error / 1e-3",
        published: [1.04, 0.627],
        ours: [Mode::Cascade, Mode::Physics].map(|mode| of(mode).map(|e| 1e3 * e)),
    });
    Ok(made)
}
