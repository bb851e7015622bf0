//! A smooth torque on a joint that no mechanism explains: a function of position, velocity, load and command.

use std::f64::consts::TAU;

/// Number of sine and cosine pairs over the range of positions.
const WAVES: usize = 12;

/// Number of functions that make up the torque.
pub const FUNCTIONS: usize = 2 * WAVES + 10;

/// Smooth torque on a joint: functions of size one, scaled by what the joint does, times their coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smooth {
    /// Lowest recorded position of the joint, rad (m).
    pub low: f64,
    /// Width of the recorded range of positions, rad (m).
    pub width: f64,
    /// RMS speed of the joint, rad/s (m/s).
    pub speed: f64,
    /// Typical torque of the joint in its motion, N·m (N).
    pub torque: f64,
    /// Coefficient of each function, N·m (N).
    pub coefficients: [f64; FUNCTIONS],
}

/// State of the joint at which the torque is asked for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Here {
    /// Position, rad (m).
    pub(crate) q: f64,
    /// Velocity, rad/s (m/s).
    pub(crate) v: f64,
    /// Torque of the drive, N·m (N).
    pub(crate) load: f64,
    /// Rate of change of the command, rad/s (m/s).
    pub(crate) rate: f64,
}

impl Default for Smooth {
    fn default() -> Self {
        Self {
            low: 0.0,
            width: 1.0,
            speed: 1.0,
            torque: 1.0,
            coefficients: [0.0; FUNCTIONS],
        }
    }
}

impl Smooth {
    /// Whether any coefficient differs from zero.
    pub(crate) fn acts(&self) -> bool {
        self.coefficients.iter().any(|c| *c != 0.0)
    }

    /// Prior deviation of coefficient `k` as a part of the torque's size. Waves that change quickly with position are
    /// likely to be small. The squares of all parts add up to one.
    pub fn weight(k: usize) -> f64 {
        let own = |k: usize| {
            if k < 2 * WAVES {
                1.0 / (k / 2 + 1) as f64
            } else {
                1.0
            }
        };
        let sum: f64 = (0..FUNCTIONS).map(|k| own(k).powi(2)).sum();
        own(k) / sum.sqrt()
    }

    /// Values of the functions at a state, without unit.
    pub(crate) fn values(&self, here: Here) -> [f64; FUNCTIONS] {
        let mut out = [0.0; FUNCTIONS];
        let (sin, cos) = self.wave(here.q);
        let (mut s, mut c) = (sin, cos);
        for m in 0..WAVES {
            (out[2 * m], out[2 * m + 1]) = (s, c);
            (s, c) = (s * cos + c * sin, c * cos - s * sin);
        }
        let (slow, fast) = (0.1 * self.speed, self.speed);
        let soft = |x: f64, size: f64| x / (x.abs() + size);
        let Here { v, load, rate, .. } = here;
        let u = load / self.torque;
        let heavy = u.abs() / (1.0 + u.abs());
        out[2 * WAVES..].copy_from_slice(&[
            soft(v, slow),
            soft(v, fast),
            v * v.abs() / (fast * fast + v * v),
            soft(v, slow).abs(),
            soft(v, fast).abs(),
            soft(u, 1.0),
            u * heavy,
            soft(v, slow) * heavy,
            soft(rate, slow),
            soft(rate - v, fast),
        ]);
        out
    }

    /// Torque by the functions' values at a state, and its derivatives by position and velocity with load and command
    /// held.
    pub(crate) fn torque(&self, here: Here, values: &[f64; FUNCTIONS]) -> [f64; 3] {
        let c = &self.coefficients;
        let torque = c.iter().zip(values).map(|(c, f)| c * f).sum();
        let mut by_position = 0.0;
        for m in 0..WAVES {
            let pace = TAU * (m + 1) as f64 / self.period();
            let (sin, cos) = (values[2 * m], values[2 * m + 1]);
            by_position += pace * (c[2 * m] * cos - c[2 * m + 1] * sin);
        }
        // The functions of velocity are rational: a difference over a thousandth of the usual speed is their slope.
        let d = 1e-3 * self.speed;
        let later = self.values(Here {
            v: here.v + d,
            ..here
        });
        let change = c[2 * WAVES..]
            .iter()
            .zip(&later[2 * WAVES..])
            .zip(&values[2 * WAVES..]);
        let by_velocity = change.map(|((c, b), a)| c * (b - a) / d).sum();
        [torque, by_position, by_velocity]
    }

    /// Period of the longest wave, rad (m). It exceeds the range, so that the torque may differ at its two ends.
    fn period(&self) -> f64 {
        1.25 * self.width
    }

    fn wave(&self, q: f64) -> (f64, f64) {
        (TAU * (q - self.low) / self.period()).sin_cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_differences() {
        let mut smooth = Smooth {
            low: -1.0,
            width: 2.0,
            speed: 0.7,
            torque: 3.0,
            ..Smooth::default()
        };
        for (k, c) in smooth.coefficients.iter_mut().enumerate() {
            *c = Smooth::weight(k) * if k % 3 == 0 { -1.0 } else { 1.0 };
        }
        let here = Here {
            q: 0.3,
            v: 0.4,
            load: 2.0,
            rate: 0.6,
        };
        let at = |here: Here| smooth.torque(here, &smooth.values(here));
        let [_, by_q, by_v] = at(here);
        let d = 1e-6;
        let q = Here {
            q: here.q + d,
            ..here
        };
        let v = Here {
            v: here.v + d,
            ..here
        };
        let by = |other: Here| (at(other)[0] - at(here)[0]) / d;
        assert!((by(q) - by_q).abs() < 1e-3 * by_q.abs(), "{} {by_q}", by(q));
        assert!((by(v) - by_v).abs() < 2e-2 * by_v.abs(), "{} {by_v}", by(v));
    }
}
