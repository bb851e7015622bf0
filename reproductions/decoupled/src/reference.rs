//! Motions that are commanded to one joint, with exact derivatives.

use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Position (rad), velocity and acceleration.
pub type State = [f64; 3];

/// A motion of one joint.
#[derive(Debug, Clone, PartialEq)]
pub enum Reference {
    /// Finite Fourier series.
    Periodic(Fourier),
    /// There and back between two positions, at constant speed in between.
    Shuttle(Shuttle),
}

impl Reference {
    /// State at time `t`, s.
    pub fn at(&self, t: f64) -> State {
        match self {
            Self::Periodic(series) => series.at(t),
            Self::Shuttle(shuttle) => shuttle.at(t),
        }
    }

    /// The time after which it repeats itself, s.
    pub fn period(&self) -> f64 {
        match self {
            Self::Periodic(series) => 1.0 / series.fundamental_hz,
            Self::Shuttle(shuttle) => shuttle.period(),
        }
    }
}

/// q = q₀ + Σ a_k/(ω k) sin(ω k t) − b_k/(ω k) cos(ω k t), ω = 2π f₀ (COMAU paper, equations 17 to 19).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fourier {
    /// f₀, Hz.
    pub fundamental_hz: f64,
    /// q₀, rad.
    pub centre: f64,
    /// (a_k, b_k), rad/s, from k = 1.
    pub waves: Vec<[f64; 2]>,
}

impl Fourier {
    /// State at time `t`, s.
    pub fn at(&self, t: f64) -> State {
        let mut state = [self.centre, 0.0, 0.0];
        for (k, [a, b]) in self.waves.iter().enumerate() {
            let w = TAU * self.fundamental_hz * (k + 1) as f64;
            let (sin, cos) = (w * t).sin_cos();
            state[0] += (a * sin - b * cos) / w;
            state[1] += a * cos + b * sin;
            state[2] += w * (b * cos - a * sin);
        }
        state
    }
}

/// There and back around a centre with trapezoidal velocity; with no cruise at all the acceleration is bang-bang.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shuttle {
    /// Where it starts, rad.
    pub start: f64,
    /// Speed of the cruise, rad/s.
    pub speed: f64,
    /// Acceleration, rad/s².
    pub acceleration: f64,
    /// Time at constant speed, s.
    pub cruise: f64,
}

impl Shuttle {
    /// Time of one way.
    fn way(&self) -> f64 {
        2.0 * self.speed / self.acceleration + self.cruise
    }

    /// Time there and back, s.
    pub fn period(&self) -> f64 {
        2.0 * self.way()
    }

    /// State at time `t`, s.
    pub fn at(&self, t: f64) -> State {
        let (way, gather) = (self.way(), self.speed / self.acceleration);
        let x = t.rem_euclid(self.period());
        let (x, back) = if x < way { (x, false) } else { (x - way, true) };
        let length = self.speed * (gather + self.cruise);
        let [s, v, a] = if x < gather {
            let a = self.acceleration;
            [0.5 * a * x * x, a * x, a]
        } else if x < gather + self.cruise {
            let s = self.speed * (0.5 * gather + x - gather);
            [s, self.speed, 0.0]
        } else {
            let (left, a) = (way - x, self.acceleration);
            [length - 0.5 * a * left * left, a * left, -a]
        };
        if back {
            [self.start + length - s, -v, -a]
        } else {
            [self.start + s, v, a]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_exact() {
        let series = Fourier {
            fundamental_hz: 0.1,
            centre: 0.2,
            waves: vec![[0.3, -0.2], [0.1, 0.4], [-0.2, 0.1]],
        };
        let shuttle = Shuttle {
            start: -0.5,
            speed: 0.4,
            acceleration: 0.8,
            cruise: 1.0,
        };
        let h = 1e-5;
        for motion in [Reference::Periodic(series), Reference::Shuttle(shuttle)] {
            for k in 0..200 {
                let t = 0.0137 + 0.11 * f64::from(k);
                let [before, here, after] = [t - h, t, t + h].map(|t| motion.at(t));
                assert!((after[0] - before[0] - 2.0 * h * here[1]).abs() < 1e-9);
                assert!(
                    (after[1] - before[1] - 2.0 * h * here[2]).abs() < 1e-8,
                    "{t}"
                );
            }
            let [a, b] = [0.3, 0.3 + motion.period()].map(|t| motion.at(t));
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9));
        }
    }
}
