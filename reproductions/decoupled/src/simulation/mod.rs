//! A joint under its controller, recorded with noise.

mod pid;
mod plant;

pub use pid::Pid;
pub use plant::Plant;

use crate::joint::Joint;
use crate::reference::Reference;
use crate::run::Run;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Rate of controller and recording: 1 kHz, as in the paper.
pub const STEP: f64 = 1e-3;
/// Steps of the plant in one of the controller.
const FINER: usize = 4;
/// Time over which the joint is led from rest into the reference, s.
const LEAD_IN: f64 = 2.0;

/// Sensors and controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// Encoder's count, seen at the joint, rad.
    pub resolution: f64,
    /// Noise of position, rad.
    pub position_noise: f64,
    /// Noise of the recorded torque relative to its root mean square.
    pub torque_noise: f64,
    /// Bandwidth of the controller, Hz.
    pub bandwidth: f64,
}

impl Default for Setup {
    /// Noise of position ten times the encoder's count, torque noise of 5 %.
    fn default() -> Self {
        Self {
            resolution: 1e-5,
            position_noise: 1e-4,
            torque_noise: 0.05,
            bandwidth: 4.0,
        }
    }
}

/// What the controller adds to its own feedback at a commanded state: a model's torque.
pub type Feedforward<'a> = &'a dyn Fn([f64; 3]) -> f64;

/// What happened, with what the sensors did not see.
pub struct Trace {
    /// The run as recorded.
    pub run: Run,
    /// True position at each sample.
    pub q: Vec<f64>,
}

/// Runs a reference for `seconds` after as long a lead-in as one period (at least two seconds) and records it.
///
/// The torque is held over a control period; what is recorded is the mean of the periods before and after a sample.
pub fn simulate(
    joint: &Joint,
    reference: &Reference,
    seconds: f64,
    setup: &Setup,
    feedforward: Option<Feedforward>,
    seed: u64,
) -> Trace {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let period = reference.period();
    let lead = period * (LEAD_IN / period).ceil().max(1.0);
    let count = |time: f64| (time / STEP).round() as usize;
    let (before, samples) = (count(lead), count(seconds));
    let start = reference.at(0.0)[0];
    let mut plant = Plant::new(*joint, start);
    let mut pid = Pid::new(joint.inertia, setup.bandwidth, STEP);
    let mut held = Vec::with_capacity(before + samples + 1);
    let mut run = Run {
        source: "simulation".to_owned(),
        step: STEP,
        reference: Vec::with_capacity(samples),
        period,
        q: Vec::with_capacity(samples),
        tau: Vec::with_capacity(samples),
    };
    let mut truth = Vec::with_capacity(samples);
    for k in 0..=before + samples {
        let t = k as f64 * STEP;
        let command = reference.at(t);
        let swell = (t / LEAD_IN).min(1.0);
        let swell = swell * swell * (3.0 - 2.0 * swell);
        let wanted = if swell < 1.0 {
            start + swell * (command[0] - start)
        } else {
            command[0]
        };
        let noisy = plant.q + setup.position_noise * normal();
        let measured = if setup.resolution > 0.0 {
            (noisy / setup.resolution).round() * setup.resolution
        } else {
            noisy
        };
        let known = feedforward.map_or(0.0, |f| swell * f(command));
        let u = known + pid.torque(wanted - measured);
        held.push(u);
        if (before..before + samples).contains(&k) {
            run.reference.push(command);
            run.q.push(measured);
            truth.push(plant.q);
        }
        for _ in 0..FINER {
            plant.step(u, STEP / FINER as f64);
        }
    }
    run.tau = (before..before + samples)
        .map(|k| 0.5 * (held[k - 1] + held[k]))
        .collect();
    let squares: f64 = run.tau.iter().map(|t| t * t).sum();
    let size = setup.torque_noise * (squares / samples.max(1) as f64).sqrt();
    for tau in &mut run.tau {
        *tau += size * normal();
    }
    Trace { run, q: truth }
}
