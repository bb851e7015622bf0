//! An arm recorded twice: without and with a body on its last link.

use super::effects::JointEffects;
use super::excitation::{RUNS, excitation};
use super::runs::{Machine, Plan};
use super::ur5;
use crate::SimulateError;
use crate::cases::write_whole;
use datasets::Recording;
use nalgebra::{Matrix3, Vector3};
use physics::robot::{Inertia, Robot, to_urdf};
use plant::families;
use plant::measure::Errors;
use plant::random::unit_vector;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};

/// Arm that is recorded with and without a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoadedArm {
    /// UR5 of the simulated protocol of the UR5 paper (uncertainty compensation).
    Ur5,
    /// A seven-joint arm of the family of simulated cases.
    Seven,
}

impl LoadedArm {
    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ur5 => "ur5",
            Self::Seven => "seven",
        }
    }

    pub(super) fn machine(self) -> Result<Machine, SimulateError> {
        match self {
            Self::Ur5 => ur5::machine(),
            Self::Seven => Ok(seven()),
        }
    }
}

/// Recordings of one arm without and with a body.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// Robot as its description has it.
    pub robot: Robot,
    /// Four excitations without the body.
    pub without: Recording,
    /// One excitation of 25 s with the body.
    pub with: Recording,
    /// Body on the last link, in the last joint's frame.
    pub body: Inertia,
    /// True factors on the recorded torque of each joint: ones, except for [`Loaded::with_wrong_drives`].
    pub gains: Vec<f64>,
}

/// Simulates both recordings; `plain`: the arm without anything that a rigid model with viscous and Coulomb friction lacks.
///
/// # Errors
/// The simulated robot is not a possible one.
pub fn loaded(arm: LoadedArm, plain: bool, seed: u64) -> Result<Loaded, SimulateError> {
    let machine = arm.machine()?;
    let machine = if plain { machine.plain() } else { machine };
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let body = body(&mut rng);
    let mut carrying = machine.clone();
    carrying.arm.attach(&body);
    let n = machine.arm.dof();
    let mut plan = |index: usize| excitation(&machine.arm, index, 0.0, &mut rng);
    let without: Vec<Plan> = (0..RUNS).map(&mut plan).collect();
    let with = [plan(RUNS)];
    let one = |recordings: Vec<Recording>| {
        let [recording] = <[Recording; 1]>::try_from(recordings)
            .unwrap_or_else(|_| unreachable!("one part was asked for"));
        recording
    };
    Ok(Loaded {
        robot: machine.arm.robot()?,
        without: one(machine.record(&without, 1, seed, &|_| {})?),
        with: one(carrying.record(&with, 1, seed ^ 0x9e37_79b9, &|_| {})?),
        body,
        gains: vec![1.0; n],
    })
}

/// A body of 1 to 4 kg up to 0.25 m beyond the flange, not a point.
pub(super) fn body(rng: &mut ChaCha8Rng) -> Inertia {
    let mass = rng.random_range(1.0..4.0);
    let com = Vector3::new(0.0, 0.0, rng.random_range(0.05..0.2)) + 0.06 * unit_vector(rng);
    let gyration = Vector3::from_fn(|_, _| rng.random_range(0.04..0.1_f64));
    let squares = gyration.component_mul(&gyration);
    // No body's moment exceeds the sum of the two others; one of a flat plate nearly does.
    let most = 0.95 * (squares.sum() - squares.max());
    let about_com = Matrix3::from_diagonal(&squares.map(|s| s.min(most))) * mass;
    Inertia::from_com(mass, com, about_com)
}

/// Seven-joint arm whose gears have ripple and the friction effects of [`JointEffects`] at a moderate size.
fn seven() -> Machine {
    let arm = families::panda_like7();
    let torque: Vec<f64> = arm.friction().iter().map(|c| 0.06 * c).collect();
    let effects = arm.joints.iter().map(|joint| JointEffects {
        ripple: 0.05 * joint.friction,
        order: 11.3,
        stribeck: 0.25 * joint.friction,
        stribeck_speed: 0.12,
        flow: 0.0,
        loss: 0.05,
        deflection: 0.01,
        cold: 0.2,
    });
    Machine {
        effects: effects.collect(),
        warm_up: (700.0, vec![3.0, 3.0, 2.5, 2.5, 1.2, 1.2, 1.0]),
        more: |_| Vec::new(),
        errors: Errors {
            count: vec![TAU / f64::from(1 << 18); 7],
            velocity: vec![0.002; 7],
            torque,
        },
        gears: Vec::new(),
        bandwidth: 8.0,
        arm,
    }
}

impl Loaded {
    /// The recordings with torque constants that are wrong by a factor between 0.8 and 1.25 in each joint's
    /// drive, noise included.
    pub fn with_wrong_drives(mut self, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x6a09_e667);
        for (j, gain) in self.gains.iter_mut().enumerate() {
            *gain = rng.random_range(0.8_f64.ln()..1.25_f64.ln()).exp();
            for tau in [&mut self.without.tau, &mut self.with.tau]
                .into_iter()
                .flatten()
            {
                tau.column_mut(j).mapv_inplace(|v| v / *gain);
            }
        }
        self
    }

    /// Writes `robot.urdf`, `without.parquet`, `with.parquet` and `truth.json` into `folder`; returns the files.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, SimulateError> {
        fs::create_dir_all(folder).map_err(|source| SimulateError::Write {
            path: folder.to_owned(),
            source,
        })?;
        let [urdf, without, with, truth] = [
            "robot.urdf",
            "without.parquet",
            "with.parquet",
            "truth.json",
        ]
        .map(|n| folder.join(n));
        write_whole(&urdf, &to_urdf(&self.robot))?;
        datasets::write(&self.without, &without)?;
        datasets::write(&self.with, &with)?;
        let about = self.body.about_com();
        let value = serde_json::json!({
            "mass": self.body.mass,
            "com": self.body.com().as_slice(),
            "inertia": [about.m11, about.m12, about.m22, about.m13, about.m23, about.m33],
            "gains": self.gains,
        });
        write_whole(&truth, &format!("{value:#}\n"))?;
        Ok(vec![urdf, without, with, truth])
    }
}
