//! A first look at a diagnosis: a UR5 on two days, with a body on its last link and more friction in two joints than its description has.

use super::excitation::excitation;
use super::runs::Plan;
use super::ur5;
use crate::SimulateError;
use crate::cases::write_whole;
use datasets::Recording;
use nalgebra::{Matrix3, Vector3};
use physics::robot::{Inertia, Robot, to_urdf};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::fs;
use std::path::Path;

/// Number of excitations on each of the days.
const RUNS: usize = 2;
/// Mass, kg, and centre of mass in the last joint's frame, m, of the body.
const MASS: f64 = 1.2;
const CENTRE: [f64; 3] = [0.02, 0.0, 0.09];
/// Radius of gyration of the body, m.
const GYRATION: f64 = 0.05;
/// Indices of the joints with increased Coulomb friction, and the factors on it.
const RUBS: [(usize, f64); 2] = [(1, 1.8), (2, 1.6)];
/// Bits by which the seed differs for the second day's noise and motion.
const OTHER_DAY: u64 = 0x9e37_79b9;

/// An arm's description, and its recordings.
#[derive(Debug, Clone)]
pub struct Demo {
    /// Robot as its description has it.
    pub robot: Robot,
    /// Recording of the first day.
    pub monday: Recording,
    /// Recording of the second day.
    pub friday: Recording,
}

/// Simulates both days.
///
/// # Errors
/// The simulated robot is not a possible one.
pub fn demo(seed: u64) -> Result<Demo, SimulateError> {
    let mut machine = ur5::machine()?.plain();
    let robot = machine.arm.robot()?;
    let about = Matrix3::from_diagonal_element(MASS * GYRATION * GYRATION);
    let body = Inertia::from_com(MASS, Vector3::from(CENTRE), about);
    machine.arm.attach(&body);
    for (joint, factor) in RUBS {
        machine.arm.joints[joint].friction *= factor;
    }
    let day = |seed: u64| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let plans: Vec<Plan> = (0..RUNS)
            .map(|index| excitation(&machine.arm, index, 0.0, &mut rng))
            .collect();
        let mut parts = machine.record(&plans, 1, seed, &|_| {})?;
        Ok::<Recording, SimulateError>(parts.remove(0))
    };
    Ok(Demo {
        monday: day(seed)?,
        friday: day(seed ^ OTHER_DAY)?,
        robot,
    })
}

impl Demo {
    /// Writes `robot.urdf`, `monday.parquet` and `friday.parquet` into `folder`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), SimulateError> {
        fs::create_dir_all(folder).map_err(|source| SimulateError::Write {
            path: folder.to_owned(),
            source,
        })?;
        write_whole(&folder.join("robot.urdf"), &to_urdf(&self.robot))?;
        datasets::write(&self.monday, &folder.join("monday.parquet"))?;
        datasets::write(&self.friday, &folder.join("friday.parquet"))?;
        Ok(())
    }
}
