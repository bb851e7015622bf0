//! The identified joint judged on trapezoids, and its model in the loop (COMAU paper, sections 3.5 and 3.6).

use crate::joint::Joint;
use crate::reference::{Reference, Shuttle};
use crate::simulation::{Setup, simulate};
use identify::residuals::residual_tests;
use serde::Serialize;

/// Trapezoidal velocity, moving there and back three times.
pub const TRAPEZOID: Shuttle = Shuttle {
    start: -0.8,
    speed: 0.8,
    acceleration: 2.0,
    cruise: 1.5,
};
const WAYS: f64 = 3.0;

/// Difference between the recorded joint and the identified one under the same controller.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Validation {
    /// Largest position error, rad.
    pub position: f64,
    /// RMS of the torque error, N·m.
    pub torque: f64,
    /// RMS of the noise in the recorded torque, N·m: what a perfect model leaves.
    pub noise: f64,
    /// Skewness and excess kurtosis of the position and of the torque error: zero where their densities are normal.
    pub shape: [[f64; 2]; 2],
}

/// Runs `joint` with noise and `model` without, both under the controller that `joint` has.
pub fn validate(joint: &Joint, model: &Joint, setup: &Setup, seed: u64) -> Validation {
    let reference = Reference::Shuttle(TRAPEZOID);
    let seconds = WAYS * TRAPEZOID.period();
    let quiet = Setup {
        position_noise: 0.0,
        torque_noise: 0.0,
        resolution: 0.0,
        ..*setup
    };
    let of = |joint: &Joint, setup: &Setup| simulate(joint, &reference, seconds, setup, None, seed);
    let (real, made, silent) = (of(joint, setup), of(model, &quiet), of(joint, &quiet));
    let differences =
        |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
    let position = differences(&real.run.q, &made.run.q);
    let torque = differences(&real.run.tau, &made.run.tau);
    let noise = differences(&real.run.tau, &silent.run.tau);
    let rms = |e: &[f64]| (e.iter().map(|e| e * e).sum::<f64>() / e.len().max(1) as f64).sqrt();
    let shape = |e: &[f64]| {
        residual_tests(e, e, e, &[]).map_or([0.0; 2], |t| {
            [t.normality.skewness, t.normality.excess_kurtosis]
        })
    };
    Validation {
        position: position.iter().fold(0.0, |m, e| m.max(e.abs())),
        torque: rms(&torque),
        noise: rms(&noise),
        shape: [shape(&position), shape(&torque)],
    }
}

/// Tracking errors of the joint's true position, rad.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tracking {
    /// Root mean square.
    pub rms: f64,
    /// Largest of all.
    pub peak: f64,
    /// Largest within a quarter of a second after the reference changes the sign of its velocity.
    pub reversal: f64,
}

/// Time after a reversal that counts to it, s.
const AFTER: f64 = 0.25;

/// Tracks the trapezoids under the controller alone, and with the model's torque at the commanded motion added to it.
pub fn track(joint: &Joint, model: &Joint, setup: &Setup, seed: u64) -> [Tracking; 2] {
    let reference = Reference::Shuttle(TRAPEZOID);
    let seconds = WAYS * TRAPEZOID.period();
    let torque = |[q, v, a]: [f64; 3]| model.torque(q, v, a);
    [None, Some(&torque as &dyn Fn([f64; 3]) -> f64)].map(|model| {
        let trace = simulate(joint, &reference, seconds, setup, model, seed);
        let error = |k: usize| (trace.q[k] - trace.run.reference[k][0]).abs();
        let all: Vec<f64> = (0..trace.q.len()).map(error).collect();
        let r = &trace.run.reference;
        let after = (AFTER / trace.run.step) as usize;
        let reversals = (1..r.len()).filter(|&k| r[k][1] * r[k - 1][1] < 0.0);
        let near = reversals.flat_map(|k| k..(k + after).min(all.len()));
        Tracking {
            rms: (all.iter().map(|e| e * e).sum::<f64>() / all.len() as f64).sqrt(),
            peak: all.iter().fold(0.0, |m, e| m.max(*e)),
            reversal: near.fold(0.0, |m, k| m.max(all[k])),
        }
    })
}
