//! An arm recorded on two days, between which one thing was changed.

use super::excitation::{RUNS, excitation};
use super::payload::{LoadedArm, body};
use super::runs::{Machine, Plan};
use crate::SimulateError;
use crate::cases::write_whole;
use datasets::Recording;
use nalgebra::Vector3;
use physics::robot::to_urdf;
use plant::arm::{Arm, altered};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};

/// Change of the robot between the two days.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Change {
    /// No change between the days.
    None,
    /// A body of 1 to 4 kg on the last link.
    Payload,
    /// Viscous and Coulomb friction of one joint, by 0.6 to 0.8 or 1.3 to 1.8.
    FrictionParameters,
    /// Torque constant of one drive, by 5 to 15 %.
    TorqueGain,
    /// Mount of the base, 1 to 3 degrees.
    BaseTilt,
    /// Zero of one joint, 0.01 to 0.04 rad; not the first, about whose vertical axis nothing weighs, nor the last.
    EncoderOffset,
}

impl Change {
    /// All kinds of changes, none first.
    pub const ALL: [Self; 6] = [
        Self::None,
        Self::Payload,
        Self::FrictionParameters,
        Self::TorqueGain,
        Self::BaseTilt,
        Self::EncoderOffset,
    ];

    /// Name of the effect in a diagnosis.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Payload => "payload",
            Self::FrictionParameters => "friction_parameters",
            Self::TorqueGain => "torque_gain",
            Self::BaseTilt => "base_tilt",
            Self::EncoderOffset => "encoder_offset",
        }
    }
}

/// Change between two days, with its size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Changed {
    /// Kind of what was changed.
    pub change: Change,
    /// Name of its joint, where it has one.
    pub joint: Option<String>,
    /// The size: mass of the body, kg; factor on friction or on the recorded torque; angle of the tilt or of the zero, rad.
    pub size: f64,
    /// Vector of the change: centre of mass of the body in the last joint's frame, m, or rotation vector of the tilt,
    /// rad.
    pub vector: Option<[f64; 3]>,
}

/// Recordings of one arm before and after.
#[derive(Debug, Clone)]
pub struct Days {
    /// The arm as its description has it: inertials up to a fifth off, no friction.
    pub urdf: String,
    /// Recording of four excitations before the change.
    pub before: Recording,
    /// Recording of four excitations after the change.
    pub after: Recording,
    /// True change between the two days.
    pub truth: Changed,
}

/// Additional time for which the arm was warm when the second day's first trajectory began, s.
const WARMER: f64 = 30.0;

/// Simulates both days. `again`: both days' motions are the same. `plain`: the arm has no effects beyond a
/// rigid model with viscous and Coulomb friction.
///
/// # Errors
/// The simulated robot is not a possible one.
pub fn changed(
    arm: LoadedArm,
    change: Change,
    again: bool,
    plain: bool,
    seed: u64,
) -> Result<Days, SimulateError> {
    let machine = arm.machine()?;
    let machine = if plain { machine.plain() } else { machine };
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x6265_666f_7265);
    let (other, gain, truth) = altered_by(change, &machine, &mut rng);
    let mut day = |start: f64| -> Vec<Plan> {
        (0..RUNS)
            .map(|index| excitation(&machine.arm, index, start, &mut rng))
            .collect()
    };
    let first = day(0.0);
    let mut second = day(WARMER);
    if again {
        for (own, earlier) in second.iter_mut().zip(&first) {
            own.session = earlier.session.clone();
        }
    }
    let urdf = to_urdf(&described(&machine.arm, &mut rng).robot()?);
    let one = |machine: &Machine, plans: &[Plan], seed: u64| {
        machine
            .record(plans, 1, seed, &|_| {})
            .map(|mut r| r.remove(0))
    };
    let before = one(&machine, &first, seed)?;
    let mut after = one(&other, &second, seed ^ 0x9e37_79b9)?;
    if let Some(tau) = &mut after.tau {
        for (mut column, gain) in tau.columns_mut().into_iter().zip(gain) {
            column.mapv_inplace(|v| v * gain);
        }
    }
    Ok(Days {
        urdf,
        before,
        after,
        truth,
    })
}

/// The arm in a description without measured parameters.
fn described(arm: &Arm, rng: &mut ChaCha8Rng) -> Arm {
    let mut arm = arm.clone();
    for joint in &mut arm.joints {
        let body = &joint.link.inertia;
        let shift = Vector3::from_fn(|_, _| rng.random_range(-0.1..0.1)) * body.com().norm();
        let (mass, inertia) = (rng.random_range(0.8..1.2), rng.random_range(0.9..1.1));
        joint.link.inertia = altered(body, mass, shift, inertia);
        joint.damping = 0.0;
        joint.friction = 0.0;
    }
    arm
}

/// The arm after the change, the factors on its recorded torques, and the change.
fn altered_by(
    change: Change,
    machine: &Machine,
    rng: &mut ChaCha8Rng,
) -> (Machine, Vec<f64>, Changed) {
    let mut other = machine.clone();
    let n = machine.arm.dof();
    let mut gain = vec![1.0; n];
    let joint = match change {
        Change::EncoderOffset => rng.random_range(1..n - 1),
        _ => rng.random_range(0..n),
    };
    let mut truth = Changed {
        change,
        joint: Some(machine.arm.joints[joint].name.clone()),
        size: 0.0,
        vector: None,
    };
    match change {
        Change::None => truth.joint = None,
        Change::Payload => {
            let body = body(rng);
            other.arm.attach(&body);
            truth.joint = None;
            truth.size = body.mass;
            truth.vector = Some(body.com().into());
        }
        Change::FrictionParameters => {
            truth.size = if rng.random_bool(0.5) {
                rng.random_range(0.6..0.8)
            } else {
                rng.random_range(1.3..1.8)
            };
            let own = &mut other.arm.joints[joint];
            own.damping *= truth.size;
            own.friction *= truth.size;
        }
        Change::TorqueGain => {
            let off: f64 = rng.random_range(0.05..0.15);
            truth.size = if rng.random_bool(0.5) {
                1.0 + off
            } else {
                1.0 - off
            };
            gain[joint] = truth.size;
        }
        Change::BaseTilt => {
            truth.size = rng.random_range(1.0..3.0_f64).to_radians();
            let towards = rng.random_range(0.0..TAU);
            let tilt = Vector3::new(towards.cos(), towards.sin(), 0.0) * truth.size;
            other.arm.tilt(tilt);
            truth.joint = None;
            truth.vector = Some(tilt.into());
        }
        Change::EncoderOffset => {
            let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
            truth.size = sign * rng.random_range(0.01..0.04);
            other.arm.shift_zero(joint, truth.size);
        }
    }
    (other, gain, truth)
}

impl Days {
    /// Writes `robot.urdf`, `before.parquet`, `after.parquet` and `truth.json` into `folder`; returns the files.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, SimulateError> {
        fs::create_dir_all(folder).map_err(|source| SimulateError::Write {
            path: folder.to_owned(),
            source,
        })?;
        let names = [
            "robot.urdf",
            "before.parquet",
            "after.parquet",
            "truth.json",
        ];
        let [urdf, before, after, truth] = names.map(|n| folder.join(n));
        write_whole(&urdf, &self.urdf)?;
        datasets::write(&self.before, &before)?;
        datasets::write(&self.after, &after)?;
        let text =
            serde_json::to_string_pretty(&self.truth).map_err(|source| SimulateError::Json {
                path: truth.clone(),
                source,
            })?;
        write_whole(&truth, &(text + "\n"))?;
        Ok(vec![urdf, before, after, truth])
    }
}
