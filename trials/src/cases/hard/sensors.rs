//! Stamps, counts and velocity of the log.

use super::TRACE_HZ;
use datasets::{Recording, Trajectory};
use ndarray::Array2;
use plant::measure::Errors;
use plant::run::Trace;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::ops::Range;

/// Irregularity of the sampling times.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Jitter {
    /// Regular sampling times with exact stamps.
    None,
    /// Even sampling times with irregular stamps.
    Stamps,
    /// Irregular sampling times with right stamps.
    Sampling,
}

impl Jitter {
    /// Name of the irregularity in the answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Stamps => "stamps",
            Self::Sampling => "sampling",
        }
    }
}

/// Sampling of motion and torque in the log.
pub struct Log {
    /// Sampling rate of the log, Hz.
    pub rate: f64,
    /// Irregularity of the sampling times.
    pub jitter: Jitter,
    /// Standard deviation of a time stamp over the time between samples.
    pub uneven: f64,
    /// Whether velocity is logged.
    pub velocity: bool,
}

/// Random properties of a log.
pub fn draw(rng: &mut ChaCha8Rng) -> Log {
    let rate = [50.0, 100.0, 250.0][rng.random_range(0..3)];
    let jitter = match rng.random_range(0..10) {
        0..4 => Jitter::None,
        4..7 => Jitter::Stamps,
        _ => Jitter::Sampling,
    };
    Log {
        rate,
        jitter,
        uneven: rng.random_range(0.02..0.15),
        velocity: rng.random_bool(0.5),
    }
}

impl Log {
    /// The log of some stretches of a trace, one trajectory each; `torque` is on the clock of the trace. Positions of links and relative
    /// temperatures are the true ones.
    pub fn record(
        &self,
        trace: &Trace,
        torque: &[f64],
        errors: &Errors,
        parts: &[Range<usize>],
        rng: &mut ChaCha8Rng,
    ) -> Recording {
        let n = trace.dof;
        let tick = 1.0 / TRACE_HZ;
        let (mut time, mut q, mut qd, mut tau) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut link, mut warmth) = (Vec::new(), Vec::new());
        let last = trace.len() - 1;
        let mut trajectories = Vec::new();
        for (index, part) in parts.iter().enumerate() {
            let first = time.len();
            for (at, stamp) in self.times(part, rng) {
                let (k, w) = (at as usize, at.fract());
                time.push(trace.time[part.start] + (stamp - part.start as f64) * tick);
                for j in 0..n {
                    let normal = |rng: &mut ChaCha8Rng| -> f64 { StandardNormal.sample(rng) };
                    let [position, velocity] = trace.between(j, k, w, tick);
                    q.push((position / errors.count[j]).round() * errors.count[j]);
                    qd.push(velocity + errors.velocity[j] * normal(rng));
                    // The log has the number of the nearest tick.
                    tau.push(torque[at.round() as usize * n + j]);
                    let [before, after] = [k, (k + 1).min(last)].map(|row| trace.link[row * n + j]);
                    link.push(before + w * (after - before));
                    warmth.push(trace.warmth[k * n + j]);
                }
            }
            trajectories.push(Trajectory {
                label: (index + 1).to_string(),
                range: first..time.len(),
            });
        }
        let rows = time.len();
        let table = |values: Vec<f64>| Array2::from_shape_fn((rows, n), |(k, j)| values[k * n + j]);
        let mut recording = Recording::new("simulation", time, table(q), Some(table(tau)));
        recording.qd = self.velocity.then(|| table(qd));
        recording.ql = Some(table(link));
        recording.temp = Some(table(warmth));
        recording.trajectories = trajectories;
        recording
    }

    /// Times of the samples of a stretch and their stamps, in ticks of the trace.
    fn times(&self, part: &Range<usize>, rng: &mut ChaCha8Rng) -> Vec<(f64, f64)> {
        let step = TRACE_HZ / self.rate;
        // A step at either end for samples that are moved.
        let count = ((part.len() as f64 - 1.0) / step) as usize;
        let one = |k: usize| {
            let even = part.start as f64 + k as f64 * step;
            let z: f64 = StandardNormal.sample(rng);
            let moved = even + (self.uneven * z).clamp(-0.4, 0.4) * step;
            match self.jitter {
                Jitter::None => (even, even),
                Jitter::Stamps => (even, moved),
                Jitter::Sampling => (moved, moved),
            }
        };
        (1..count).map(one).collect()
    }
}
