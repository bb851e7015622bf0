//! Something unknown on a joint: a smooth torque of its position, velocity, load and direction.
//!
//! The torque is a Gaussian process of these four, written as a sum of random Fourier features with normal
//! coefficients (Rahimi & Recht, 2007).

use crate::motion::frame::Frame;
use crate::motion::scene::Scene;
use ndarray::{Array1, Array2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::f64::consts::TAU;

/// Number of features of a joint.
pub(super) const FEATURES: usize = 64;
/// Shortest and longest length over which the torque changes, over half the range of a position and the typical size of
/// the others. Each feature draws its own, uniformly in the logarithm: rough torque is as likely as smooth torque.
const LENGTHS: (f64, f64) = (0.2, 1.5);
/// Seed of the features: the same for every joint and recording.
const SEED: u64 = 64;

/// Features of a joint on the fitted rows, shape (features, rows). Their squares sum to one on average.
pub(super) fn features(scene: &Scene, frame: &Frame, joint: usize) -> Array2<f64> {
    let motion = scene.motion;
    let (low, high) = scene.scale.range[joint];
    let (middle, half) = (0.5 * (low + high), (0.5 * (high - low)).max(1e-9));
    let load = scene.rigid.column(joint);
    let size = (load.dot(&load) / load.len().max(1) as f64)
        .sqrt()
        .max(1e-9);
    let columns: [Array1<f64>; 4] = [
        motion.q.column(joint).mapv(|q| (q - middle) / half),
        motion
            .qd
            .column(joint)
            .mapv(|v| v / scene.scale.speed[joint]),
        load.mapv(|t| t / size),
        scene.sign.column(joint).to_owned(),
    ];
    let each: Vec<&Array1<f64>> = columns.iter().collect();
    let states = frame.reduce_each(&each);
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut out = Array2::zeros((FEATURES, frame.len()));
    for mut feature in out.rows_mut() {
        let (short, long) = LENGTHS;
        let length = short * (long / short).powf(rng.random::<f64>());
        let phase = TAU * rng.random::<f64>();
        let waves: [f64; 4] =
            std::array::from_fn(|_| rng.sample::<f64, _>(StandardNormal) / length);
        for (i, value) in feature.iter_mut().enumerate() {
            let at: f64 = waves.iter().zip(&states).map(|(w, s)| w * s[i]).sum();
            *value = (2.0 / FEATURES as f64).sqrt() * (at + phase).cos();
        }
    }
    out
}
