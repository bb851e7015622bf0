//! Small recordings in closed form: sums of sines, inverse dynamics, friction that falls while gears
//! warm up, a ripple of the torque, white noise. Fast to make, and every figure of theirs is known.

use datasets::{Recording, Trajectory};
use ndarray::Array2;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::Robot;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// What is recorded.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Number of trajectories.
    pub trajectories: usize,
    /// Length of each, s.
    pub seconds: f64,
    /// Sampling rate, Hz.
    pub rate: f64,
    /// Time of the first sample, s.
    pub start: f64,
    /// Time between the end of a trajectory and the start of the next, s.
    pub pause: f64,
    /// Joints, from 0, that stand still throughout.
    pub still: Vec<usize>,
    /// Seed of motion and noise.
    pub seed: u64,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            trajectories: 3,
            seconds: 5.0,
            rate: 100.0,
            start: 0.0,
            pause: 2.0,
            still: Vec::new(),
            seed: 1,
        }
    }
}

/// Viscous and Coulomb friction, ripple and noise of every joint, as a share of its largest rigid torque.
const FRICTION: [f64; 2] = [0.1, 0.05];
/// Viscous friction of a cold gear over that of a warm one, and the time constant of warming, s.
const COLD: f64 = 0.6;
const WARMING: f64 = 1000.0;
const RIPPLE: f64 = 0.02;
const NOISE: f64 = 0.005;

/// Records `robot`.
pub fn record(robot: &Robot, plan: &Plan) -> Recording {
    let n = robot.dof();
    let samples = (plan.seconds * plan.rate).round() as usize + 1;
    let rows = samples * plan.trajectories;
    let mut rng = ChaCha8Rng::seed_from_u64(plan.seed);
    let (mut q, mut tau) = (Array2::zeros((rows, n)), Array2::zeros((rows, n)));
    let mut qd = Array2::zeros((rows, n));
    let mut time = Vec::with_capacity(rows);
    let mut trajectories = Vec::new();
    let mut workspace = Workspace::new(robot);
    for k in 0..plan.trajectories {
        let waves: Vec<[[f64; 3]; 3]> = (0..n).map(|j| waves(j, plan, &mut rng)).collect();
        let start = plan.start + k as f64 * (plan.seconds + plan.pause);
        for i in 0..samples {
            let (row, t) = (k * samples + i, i as f64 / plan.rate);
            time.push(start + t);
            let at: Vec<[f64; 3]> = waves.iter().map(|w| position(w, t)).collect();
            let part = |d: usize| at.iter().map(|a| a[d]).collect::<Vec<f64>>();
            let mut torque = vec![0.0; n];
            inverse_dynamics(
                robot,
                &mut workspace,
                &part(0),
                &part(1),
                &part(2),
                &mut torque,
            );
            for j in 0..n {
                q[[row, j]] = at[j][0];
                qd[[row, j]] = at[j][1];
                tau[[row, j]] = torque[j];
            }
        }
        trajectories.push(Trajectory {
            label: format!("t{}", k + 1),
            range: k * samples..(k + 1) * samples,
        });
    }
    let sizes = largest(&tau);
    for (j, size) in sizes.into_iter().enumerate() {
        for row in 0..rows {
            let v: f64 = qd[[row, j]];
            let cold = 1.0 + COLD * (-time[row] / WARMING).exp();
            let friction = FRICTION[0] * cold * v + FRICTION[1] * (v / 1e-3).tanh();
            let ripple = RIPPLE * (9.0 * q[[row, j]]).sin();
            let noise: f64 = StandardNormal.sample(&mut rng);
            tau[[row, j]] += size * (friction + ripple + NOISE * noise);
        }
    }
    Recording {
        trajectories,
        ..Recording::new("synthetic", time, q, Some(tau))
    }
}

/// Largest torque of each joint, 1 N·m (N) at least.
fn largest(tau: &Array2<f64>) -> Vec<f64> {
    let of = |c: ndarray::ArrayView1<f64>| c.iter().fold(1.0_f64, |m, t| m.max(t.abs()));
    tau.columns().into_iter().map(of).collect()
}

/// Viscous, N·m·s/rad (N·s/m), and Coulomb friction, N·m (N), of each joint of a cold robot that [`record`] records, from its recording. The noise and
/// ripple in the largest torque make them a few per cent too large.
pub fn friction(recording: &Recording) -> Vec<[f64; 2]> {
    let tau = recording.tau.as_ref().expect("torque was recorded");
    let of = |size: f64| [FRICTION[0] * (1.0 + COLD) * size, FRICTION[1] * size];
    largest(tau).into_iter().map(of).collect()
}

/// Records `robot` into a CSV file `name` of `folder`.
///
/// # Panics
/// When the file cannot be written.
pub fn record_to(folder: &Path, name: &str, robot: &Robot, plan: &Plan) -> PathBuf {
    let path = folder.join(name);
    datasets::write(&record(robot, plan), &path).expect("the recording can be written");
    path
}

/// Amplitude (rad), angular frequency (rad/s) and phase of three sines of one joint.
fn waves(joint: usize, plan: &Plan, rng: &mut ChaCha8Rng) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| {
        let amplitude = rng.random_range(0.2..0.4) / (i + 1) as f64;
        let frequency = TAU * (i + 1) as f64 * rng.random_range(0.15..0.25);
        let phase = rng.random_range(0.0..TAU);
        let moves = !plan.still.contains(&joint);
        [if moves { amplitude } else { 0.0 }, frequency, phase]
    })
}

/// q, q̇ and q̈ at t.
fn position(waves: &[[f64; 3]; 3], t: f64) -> [f64; 3] {
    let mut at = [0.0; 3];
    for [a, w, phase] in waves {
        let (sin, cos) = (w * t + phase).sin_cos();
        at[0] += a * sin;
        at[1] += a * w * cos;
        at[2] -= a * w * w * sin;
    }
    at
}
