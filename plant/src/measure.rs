//! Sensor model, which turns a perfect trace into a recording: counts and noise.

use crate::run::Trace;
use datasets::{Recording, Trajectory};
use ndarray::Array2;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Errors of the recorded channels, per joint.
#[derive(Debug, Clone)]
pub struct Errors {
    /// Step of each encoder's count, rad.
    pub count: Vec<f64>,
    /// Deviation of recorded velocity, rad/s.
    pub velocity: Vec<f64>,
    /// Deviation of recorded torque, N·m.
    pub torque: Vec<f64>,
}

/// The recording of all trajectories, labelled from 1, and the torque noise in it.
pub fn record(
    trace: &Trace,
    noted: &[f64],
    errors: &Errors,
    rng: &mut ChaCha8Rng,
) -> (Recording, Vec<f64>) {
    let (rows, n) = (trace.len(), trace.dof);
    let table = |values: Vec<f64>| Array2::from_shape_fn((rows, n), |(k, j)| values[k * n + j]);
    let mut noise = |size: &[f64]| -> Vec<f64> {
        let draw = |j: usize, rng: &mut ChaCha8Rng| {
            let z: f64 = StandardNormal.sample(rng);
            size[j] * z
        };
        (0..rows * n).map(|i| draw(i % n, rng)).collect()
    };
    let torque_noise = noise(&errors.torque);
    let velocity_noise = noise(&errors.velocity);
    let counted = |(i, q): (usize, &f64)| {
        let count = errors.count[i % n];
        (q / count).round() * count
    };
    let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + b).collect();
    let tau = table(sum(noted, &torque_noise));
    let q = table(trace.q.iter().enumerate().map(counted).collect());
    let mut recording = Recording::new("simulation", trace.time.clone(), q, Some(tau));
    recording.qd = Some(table(sum(&trace.qd, &velocity_noise)));
    let bounds = trace.bounds();
    recording.trajectories = bounds
        .windows(2)
        .enumerate()
        .map(|(i, w)| Trajectory {
            label: (i + 1).to_string(),
            range: w[0]..w[1],
        })
        .collect();
    (recording, torque_noise)
}
