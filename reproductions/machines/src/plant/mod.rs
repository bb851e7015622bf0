//! Simulated machines with known numbers, by *other* equations than the models that are fitted to them: point masses and
//! vectors instead of formulae for axes, recursive Newton–Euler instead of Lagrange for the SCARA, energies differentiated by
//! differences instead of virtual work for the Delta, and friction whose sign is not sharp.
//!
//! Numbers are plausible for a machine of the described size unless a file names their source; the manual gives none.

mod axes;
mod carried;
mod delta;
mod mechanics;
mod motion;
mod puma;
mod scara;

use crate::MachineError;
use crate::description::{Description, Kind};
pub use carried::Carried;
use datasets::{Recording, Trajectory};
pub use mechanics::{Friction, Plant};
use motion::Course;
use ndarray::Array2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
pub use scara::ARMS as SCARA_ARMS;

/// How to simulate.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Seed of noise and of the held-out motion.
    pub seed: u64,
    /// Deviation of the torque noise over the RMS of each axis's torque.
    pub noise: f64,
    /// Length of each recording, s.
    pub seconds: f64,
    /// Samples per second.
    pub rate: f64,
    /// Factor on the frequencies of the described motion.
    pub pace: f64,
    /// Factor on the spans of the described motion.
    pub span: f64,
    /// Factor on the recorded torque of single axes (axis from 0, factor): wrong torque factors.
    pub factors: Vec<(usize, f64)>,
    /// Limit of the recorded torque of single axes (axis from 0, N·m or N): saturation.
    pub limits: Vec<(usize, f64)>,
    /// The machine as its torque model 1 idealises it: a Delta's forearms as points at their ends.
    pub ideal: bool,
    /// A body on the last axis.
    pub carried: Carried,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            seed: 1,
            noise: 0.01,
            seconds: 20.0,
            rate: 1000.0,
            pace: 1.0,
            span: 1.0,
            factors: Vec::new(),
            limits: Vec::new(),
            ideal: false,
            carried: Carried::default(),
        }
    }
}

/// Resolution of recorded positions: 17 bits a turn, a micrometre.
const TURN_COUNTS: f64 = 131_072.0;
const LINEAR_COUNT: f64 = 1e-6;

/// Recordings of a simulated machine: one with the described sine waves, one held out with another motion in the same region.
///
/// # Errors
/// A description without motion, of a kind or with a number that no plant has.
pub fn simulate(
    description: &Description,
    options: &Options,
) -> Result<[Recording; 2], MachineError> {
    let plant = plant(description, options.ideal, &options.carried)?;
    let Some(waves) = &description.motion else {
        return Err(description.wrong("has no motion to simulate; add a table [motion]".to_owned()));
    };
    for (name, value) in [
        ("seconds", options.seconds),
        ("rate", options.rate),
        ("pace", options.pace),
        ("span", options.span),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return Err(description.wrong(format!("{name} of the simulation has to be positive")));
        }
    }
    let Carried { mass, inertia } = options.carried;
    if !(mass >= 0.0 && inertia >= 0.0 && mass.is_finite() && inertia.is_finite()) {
        return Err(description.wrong("carries a body of negative mass or inertia".to_owned()));
    }
    let n = description.axis.len();
    let named = options.factors.iter().chain(&options.limits);
    if let Some((axis, _)) = named.into_iter().find(|(axis, _)| *axis >= n) {
        return Err(description.wrong(format!("has no axis {}, only {n}", axis + 1)));
    }
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    let courses = [
        Course::sine_waves(waves, options.pace, options.span),
        Course::held_out(waves, options.pace, options.span, &mut rng),
    ];
    Ok(courses.map(|course| record(description, plant.as_ref(), &course, options, &mut rng)))
}

/// The plant of a description with a body on its last axis; `ideal` as [`Options::ideal`].
///
/// # Errors
/// A number that a plant needs is missing.
pub fn plant(
    description: &Description,
    ideal: bool,
    carried: &Carried,
) -> Result<Box<dyn Plant>, MachineError> {
    let axes = description.axis.len();
    Ok(match description.kind {
        Kind::RotaryAxis => Box::new(axes::Crank::new(description.dynamic_model, carried)),
        Kind::LinearAxis => Box::new(axes::Carriage::new(description.dynamic_model, carried)),
        Kind::Scara => Box::new(scara::Scara::new(axes, description.dynamic_model, carried)),
        Kind::Delta => Box::new(delta::Delta::new(description, ideal, carried)?),
        Kind::Puma => Box::new(puma::Puma::new(description, carried)?),
    })
}

/// A recording of a course that the machine follows exactly.
fn record(
    description: &Description,
    plant: &dyn Plant,
    course: &Course,
    options: &Options,
    rng: &mut ChaCha8Rng,
) -> Recording {
    let n = description.axis.len();
    let samples = (options.seconds * options.rate).round().max(1.0) as usize;
    let friction = plant.friction();
    let time: Vec<f64> = (0..samples).map(|k| k as f64 / options.rate).collect();
    let (mut q, mut tau) = (Array2::zeros((samples, n)), Array2::zeros((samples, n)));
    for (row, &t) in time.iter().enumerate() {
        let [position, velocity, acceleration] = course.at(t);
        let torque = plant.torque(&position, &velocity, &acceleration);
        for j in 0..n {
            q[(row, j)] = position[j];
            tau[(row, j)] = torque[j] + friction[j].torque(velocity[j]);
        }
    }
    for j in 0..n {
        let mut column = tau.column_mut(j);
        let rms = (column.iter().map(|t| t * t).sum::<f64>() / samples as f64).sqrt();
        for t in &mut column {
            let z: f64 = StandardNormal.sample(rng);
            *t += options.noise * rms * z;
        }
    }
    for &(axis, factor) in &options.factors {
        tau.column_mut(axis).mapv_inplace(|t| factor * t);
    }
    for &(axis, limit) in &options.limits {
        tau.column_mut(axis)
            .mapv_inplace(|t| t.clamp(-limit, limit));
    }
    for (j, axis) in description.axis.iter().enumerate() {
        let count = match axis.kind {
            crate::description::Moves::Rotary => std::f64::consts::TAU / TURN_COUNTS,
            crate::description::Moves::Linear => LINEAR_COUNT,
        };
        q.column_mut(j)
            .mapv_inplace(|v| (v / count).round() * count);
    }
    let source = format!("simulated {}", description.name);
    let mut recording = Recording::new(&source, time, q, Some(tau));
    recording.trajectories = vec![Trajectory {
        label: "1".to_owned(),
        range: 0..samples,
    }];
    recording
}
