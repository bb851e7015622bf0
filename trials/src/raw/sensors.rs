//! Stamps, encoders and velocity as a controller logs them.

use datasets::{Recording, Trajectory};
use ndarray::Array2;
use plant::arm::Arm;
use plant::random::log_uniform;
use plant::run::Trace;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;
use std::ops::Range;

/// Sensors other than the torque's.
#[derive(Debug, Clone)]
pub struct Sensors {
    /// Sampling rate of the log, Hz.
    pub rate_hz: f64,
    /// Standard deviation of the time between samples over its mean; the stamps are right.
    pub jitter: f64,
    /// Part of the samples that is lost.
    pub lost: f64,
    /// Delay of the logged velocity after the position, s; none where it is not logged.
    pub velocity_late: Option<f64>,
    count: Vec<f64>,
    position_noise: Vec<f64>,
    velocity_noise: Vec<f64>,
}

/// Random sensors for a robot.
pub fn draw(arm: &Arm, rate_hz: f64, rng: &mut ChaCha8Rng) -> Sensors {
    let count: Vec<f64> = (0..arm.dof())
        .map(|j| arm.reach[j] / 1.4 * TAU / f64::from(1u32 << rng.random_range(15..20)))
        .collect();
    let velocity_late = match rng.random_range(0..10) {
        0..4 => None,
        4..8 => Some(0.0),
        _ => Some(rng.random_range(0.005..0.016)),
    };
    let jitter = if rng.random_bool(0.35) {
        0.0
    } else {
        log_uniform(rng, 0.01, 0.15)
    };
    Sensors {
        rate_hz,
        jitter,
        lost: if rng.random_bool(0.6) {
            0.0
        } else {
            log_uniform(rng, 0.002, 0.05)
        },
        velocity_late,
        position_noise: count
            .iter()
            .map(|c| c * rng.random_range(0.0..0.7))
            .collect(),
        velocity_noise: arm
            .speed()
            .iter()
            .map(|v| v * log_uniform(rng, 0.0005, 0.004))
            .collect(),
        count,
    }
}

impl Sensors {
    /// The log of some stretches of a trace, one trajectory each; `torque` is on the clock of the trace.
    pub fn record(
        &self,
        source: &str,
        trace: &Trace,
        torque: &[f64],
        parts: &[Range<usize>],
        rng: &mut ChaCha8Rng,
    ) -> Recording {
        let n = trace.dof;
        let tick = 1.0 / super::clock::TRACE_HZ;
        let (mut time, mut q, mut qd, mut tau) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut trajectories = Vec::new();
        for (index, part) in parts.iter().enumerate() {
            let first = time.len();
            for at in self.ticks(part, rng) {
                let (k, w) = (at as usize, at.fract());
                time.push(trace.time[k] + w * tick);
                for j in 0..n {
                    let noise = |rng: &mut ChaCha8Rng| -> f64 { StandardNormal.sample(rng) };
                    let position =
                        trace.between(j, k, w, tick)[0] + self.position_noise[j] * noise(rng);
                    q.push((position / self.count[j]).round() * self.count[j]);
                    let late = (at - self.velocity_late.unwrap_or(0.0) / tick).max(0.0);
                    let velocity = trace.between(j, late as usize, late.fract(), tick)[1];
                    qd.push(velocity + self.velocity_noise[j] * noise(rng));
                    // A number of the log is that of the last tick.
                    tau.push(torque[k * n + j] + w * (torque[(k + 1) * n + j] - torque[k * n + j]));
                }
            }
            trajectories.push(Trajectory {
                label: (index + 1).to_string(),
                range: first..time.len(),
            });
        }
        let rows = time.len();
        let table = |values: Vec<f64>| Array2::from_shape_fn((rows, n), |(k, j)| values[k * n + j]);
        let mut recording = Recording::new(source, time, table(q), Some(table(tau)));
        recording.qd = self.velocity_late.map(|_| table(qd));
        recording.trajectories = trajectories;
        recording
    }

    /// Times of the samples of a stretch, in ticks of the trace: jittered, some lost.
    fn ticks(&self, part: &Range<usize>, rng: &mut ChaCha8Rng) -> Vec<f64> {
        let step = super::clock::TRACE_HZ / self.rate_hz;
        let (start, end) = (part.start as f64 + step, part.end as f64 - 1.0 - step);
        let mut kept = Vec::new();
        let mut missing = 0usize;
        let count = ((end - start) / step) as usize;
        for k in 0..count {
            let z: f64 = StandardNormal.sample(rng);
            let moved = (self.jitter * z).clamp(-0.4, 0.4) * step;
            if missing == 0 && rng.random_bool((0.4 * self.lost).min(1.0)) {
                // Two and a half in a row, on average.
                missing = rng.random_range(1..5);
            }
            if missing > 0 {
                missing -= 1;
                continue;
            }
            kept.push(start + k as f64 * step + moved);
        }
        kept
    }
}
