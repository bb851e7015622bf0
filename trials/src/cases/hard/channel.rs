//! The torque as a drive's log has it: a filtered, quantised current with coloured noise, outliers and a bias.

use super::TRACE_HZ;
use super::sensors::Log;
use crate::cases::witness::TorqueLog;
use crate::lag::Lag;
use plant::random::log_uniform;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Largest bias, as a part of its joint's root mean square torque.
const BIAS: f64 = 0.03;

/// Torque channel between torque and log, by joint.
pub struct Channel {
    /// Filter of each joint's current.
    pub lag: Vec<Lag>,
    /// Whether the filter is the same on all joints.
    pub same: bool,
    /// Standard deviation of each joint's noise, N·m.
    pub noise: Vec<f64>,
    /// Correlation of the noise from one sample of the trace to the next, 0 to 1.
    pub colour: f64,
    /// Step of each joint's logged number, N·m.
    pub quantum: Vec<f64>,
    /// Index of the joint with a bias, and the bias, N·m.
    pub bias: (usize, f64),
    /// Number of outliers in a minute, over all joints.
    pub outliers: f64,
    /// Size of each joint's outliers, N·m.
    spike: Vec<f64>,
}

/// Torque at the stages of a channel, row after row, N·m.
pub struct Logged {
    /// Torque after the filter and with the bias, without noise, N·m.
    pub clean: Vec<f64>,
    /// Torque in the log, with noise, outliers and steps.
    pub recorded: Vec<f64>,
}

/// A channel for joints whose torque has these root mean squares.
pub fn draw(rms: &[f64], rng: &mut ChaCha8Rng) -> Channel {
    let one = |rng: &mut ChaCha8Rng| {
        let corner_hz = log_uniform(rng, 10.0, 40.0);
        if rng.random_bool(0.5) {
            Lag::First { corner_hz }
        } else {
            let damping = rng.random_range(0.6..1.0);
            Lag::Second { corner_hz, damping }
        }
    };
    let same = rng.random_bool(0.6);
    let lag = if same {
        vec![one(rng); rms.len()]
    } else {
        rms.iter().map(|_| one(rng)).collect()
    };
    let scaled = |low: f64, high: f64, rng: &mut ChaCha8Rng| -> Vec<f64> {
        rms.iter()
            .map(|r| r * log_uniform(rng, low, high))
            .collect()
    };
    let biased = rng.random_range(0..rms.len());
    Channel {
        lag,
        same,
        noise: scaled(0.008, 0.03, rng),
        colour: rng.random_range(0.3..0.85),
        quantum: scaled(0.003, 0.02, rng),
        bias: (biased, rms[biased] * rng.random_range(-BIAS..BIAS)),
        outliers: log_uniform(rng, 3.0, 30.0),
        spike: scaled(0.5, 3.0, rng),
    }
}

impl Channel {
    /// Passes a torque (row after row on the clock of the trace) through it, trajectory by trajectory.
    pub fn log(&self, torque: &[f64], bounds: &[usize], rng: &mut ChaCha8Rng) -> Logged {
        let n = self.lag.len();
        let mut clean = vec![0.0; torque.len()];
        let mut recorded = vec![0.0; torque.len()];
        let chance = self.outliers / (60.0 * TRACE_HZ * n as f64);
        let fresh = (1.0 - self.colour * self.colour).sqrt();
        for w in bounds.windows(2) {
            for j in 0..n {
                let own: Vec<f64> = (w[0]..w[1]).map(|k| torque[k * n + j]).collect();
                let bias = if j == self.bias.0 { self.bias.1 } else { 0.0 };
                let normal = |rng: &mut ChaCha8Rng| -> f64 { StandardNormal.sample(rng) };
                let mut noise = normal(rng);
                for (k, y) in (w[0]..w[1]).zip(self.lag[j].apply(&own, 1.0 / TRACE_HZ)) {
                    noise = self.colour * noise + fresh * normal(rng);
                    let outlier = if rng.random_bool(chance) {
                        self.spike[j] * normal(rng)
                    } else {
                        0.0
                    };
                    let value = y + bias + self.noise[j] * noise + outlier;
                    clean[k * n + j] = y + bias;
                    recorded[k * n + j] = (value / self.quantum[j]).round() * self.quantum[j];
                }
            }
        }
        Logged { clean, recorded }
    }

    /// Torque log on the clock of the trace, and what an observer may be told of this channel. What is off by more than five deviations
    /// of the noise and a step is an outlier.
    pub fn witnessed(
        &self,
        logged: Logged,
        rms: Vec<f64>,
        bounds: Vec<usize>,
        log: &Log,
    ) -> TorqueLog {
        let (joint, _) = self.bias;
        let n = self.lag.len();
        let numbers = logged.recorded.iter().zip(&logged.clean).enumerate();
        let outlier = numbers
            .map(|(i, (r, c))| (r - c).abs() > 5.0 * self.noise[i % n] + self.quantum[i % n])
            .collect();
        TorqueLog {
            torque: logged.recorded,
            outlier,
            bounds,
            tick: 1.0 / TRACE_HZ,
            every: (TRACE_HZ / log.rate).round() as usize,
            lag: self.lag.clone(),
            noise: self.noise.clone(),
            colour: self.colour,
            quantum: self.quantum.clone(),
            bias: Some((joint, rms[joint] * BIAS / 3f64.sqrt())),
            rms,
        }
    }

    /// Lateness of a slow torque behind each joint's filter, s: the filter's first moment.
    pub fn lateness(&self) -> Vec<f64> {
        self.lag.iter().map(|l| l.first_moment()).collect()
    }
}
