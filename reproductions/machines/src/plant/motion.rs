//! Motions: the manual's sine waves, and another one through the same region to judge by.

use crate::description::SineWaves;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Sum of waves about the middle of each axis.
pub(super) struct Course {
    axes: Vec<(f64, Vec<Wave>)>,
}

/// a sin(ω t + φ).
struct Wave {
    size: f64,
    rate: f64,
    phase: f64,
}

impl Course {
    /// From start to target and back: one wave per axis, at rest at the start.
    pub fn sine_waves(waves: &SineWaves, pace: f64, span: f64) -> Self {
        Self::of(waves, |_, half, frequency| {
            vec![Wave {
                size: -span * half,
                rate: TAU * frequency * pace,
                phase: 0.25 * TAU,
            }]
        })
    }

    /// Two waves per axis, of other frequencies and random phases, within the same spans and at about the same speeds.
    pub fn held_out(waves: &SineWaves, pace: f64, span: f64, rng: &mut ChaCha8Rng) -> Self {
        Self::of(waves, |axis, half, frequency| {
            // No two axes alike: the ratios are spread by the golden section.
            let ratio = 0.75 + 0.2 * (0.618 * axis as f64).fract();
            [(0.7, ratio), (0.3, 1.37 * ratio)]
                .map(|(size, ratio)| Wave {
                    size: size * span * half,
                    rate: TAU * frequency * pace * ratio,
                    phase: rng.random_range(0.0..TAU),
                })
                .into()
        })
    }

    fn of(waves: &SineWaves, mut axis: impl FnMut(usize, f64, f64) -> Vec<Wave>) -> Self {
        let axes = (0..waves.start.len())
            .map(|j| {
                let (start, target) = (waves.start[j], waves.target[j]);
                let half = 0.5 * (target - start);
                (start + half, axis(j, half, waves.frequency[j]))
            })
            .collect();
        Self { axes }
    }

    /// Position, velocity and acceleration at a time in s.
    pub fn at(&self, t: f64) -> [Vec<f64>; 3] {
        let mut out = [Vec::new(), Vec::new(), Vec::new()];
        for (middle, waves) in &self.axes {
            let mut state = [*middle, 0.0, 0.0];
            for wave in waves {
                let (sin, cos) = (wave.rate * t + wave.phase).sin_cos();
                state[0] += wave.size * sin;
                state[1] += wave.size * wave.rate * cos;
                state[2] -= wave.size * wave.rate * wave.rate * sin;
            }
            for (list, value) in out.iter_mut().zip(state) {
                list.push(value);
            }
        }
        out
    }
}
