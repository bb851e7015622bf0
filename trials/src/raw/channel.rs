//! Torque channel between the motor's torque and the logged number.

use crate::lag::Lag;
use plant::random::log_uniform;
use plant::run::Trace;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// A torque channel, joint by joint.
#[derive(Debug, Clone)]
pub struct Channel {
    /// Filter of the current, by joint.
    pub lag: Vec<Lag>,
    /// Shift of the torque beside the filter, s; positive where torque is logged later than motion.
    pub shift: f64,
    /// Gain of each joint's channel: logged over real torque; negative where the sign is turned.
    pub gain: Vec<f64>,
    /// Offset that is added to each joint's torque, N·m as logged.
    pub offset: Vec<f64>,
    /// Standard deviation of each joint's white noise, N·m as logged.
    pub noise: Vec<f64>,
    /// Step of each joint's logged number, N·m.
    pub quantum: Vec<f64>,
}

/// Torque on the clock of the trace, row after row.
pub struct Noted {
    /// Real torque through shift and filter alone, N·m.
    pub filtered: Vec<f64>,
    /// Torque in the log, N·m (N).
    pub recorded: Vec<f64>,
}

/// A random channel for the torque of a trace that is logged at `rate_hz`.
pub fn draw(trace: &Trace, rate_hz: f64, rng: &mut ChaCha8Rng) -> Channel {
    let n = trace.dof;
    let one = |rng: &mut ChaCha8Rng| match rng.random_range(0..10) {
        0..2 => Lag::None,
        2..5 => Lag::First {
            corner_hz: log_uniform(rng, 5.0, 40.0),
        },
        5..8 => Lag::Second {
            corner_hz: log_uniform(rng, 5.0, 40.0),
            damping: rng.random_range(0.6..1.1),
        },
        _ => Lag::MovingAverage {
            // Ten samples of the log, or of a controller that logs every other one.
            period_s: if rate_hz >= 100.0 { 1.0 } else { 0.5 } / rate_hz,
        },
    };
    let lag = if rng.random_bool(0.75) {
        vec![one(rng); n]
    } else {
        (0..n).map(|_| one(rng)).collect()
    };
    let shift = if rng.random_bool(0.5) {
        rng.random_range(-0.008..0.025)
    } else {
        0.0
    };
    let rms: Vec<f64> = (0..n)
        .map(|j| {
            let column = trace.tau.iter().skip(j).step_by(n);
            (column.map(|t| t * t).sum::<f64>() / trace.len().max(1) as f64).sqrt()
        })
        .collect();
    let calibrated = rng.random_bool(0.4);
    let gain: Vec<f64> = (0..n)
        .map(|_| match rng.random_range(0..20) {
            _ if calibrated => 1.0,
            0 => -1.0,
            1..4 => log_uniform(rng, 0.2, 4.0),
            _ => log_uniform(rng, 0.85, 1.18),
        })
        .collect();
    let biased = rng.random_bool(0.5);
    let size = |j: usize| rms[j] * gain[j].abs();
    Channel {
        shift,
        offset: (0..n)
            .map(|j| {
                let part = rng.random_range(-0.1..0.1);
                if biased { part * size(j) } else { 0.0 }
            })
            .collect(),
        noise: (0..n)
            .map(|j| log_uniform(rng, 0.004, 0.05) * size(j))
            .collect(),
        quantum: (0..n)
            .map(|j| log_uniform(rng, 0.002, 0.05) * size(j))
            .collect(),
        gain,
        lag,
    }
}

impl Channel {
    /// Passes the torque of a trace through the channel, trajectory by trajectory.
    pub fn noted(&self, trace: &Trace, rng: &mut ChaCha8Rng) -> Noted {
        let n = trace.dof;
        let mut filtered = vec![0.0; trace.tau.len()];
        let tick = 1.0 / super::clock::TRACE_HZ;
        for w in trace.bounds().windows(2) {
            for j in 0..n {
                let own: Vec<f64> = (w[0]..w[1]).map(|k| trace.tau[k * n + j]).collect();
                let own = shifted(&self.lag[j].apply(&own, tick), self.shift / tick);
                for (k, y) in (w[0]..w[1]).zip(own) {
                    filtered[k * n + j] = y;
                }
            }
        }
        let recorded = filtered.iter().enumerate().map(|(i, t)| {
            let j = i % n;
            let z: f64 = StandardNormal.sample(rng);
            let value = self.gain[j] * t + self.offset[j] + self.noise[j] * z;
            (value / self.quantum[j]).round() * self.quantum[j]
        });
        Noted {
            recorded: recorded.collect(),
            filtered,
        }
    }
}

/// x(k − ticks), linear between samples, held at the ends.
fn shifted(x: &[f64], ticks: f64) -> Vec<f64> {
    let last = x.len() as f64 - 1.0;
    let at = |k: usize| {
        let s = (k as f64 - ticks).clamp(0.0, last);
        let (i, w) = (s as usize, s.fract());
        x[i] + w * (x[(i + 1).min(x.len() - 1)] - x[i])
    };
    (0..x.len()).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_is_shifted_between_samples() {
        let x: Vec<f64> = (0..3000).map(|k| f64::from(k) * 1e-3).collect();
        assert!((shifted(&x, 12.5)[2000] - 1.9875).abs() < 1e-12);
    }
}
