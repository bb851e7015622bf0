//! Fourier series run through at a varying pace.

use super::Command;
use super::moves::smooth_step;
use crate::arm::Arm;
use crate::random::log_uniform;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Modulation of the series' pace: ds/dt = rate·exp(depth·sin(2πt/period + φ)).
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    /// Geometric middle of the pace, periods of the series per second.
    pub rate: f64,
    /// Depth of the pace's variation; 0 runs at constant pace.
    pub depth: f64,
    /// Period of the variation, s.
    pub period: f64,
    /// Number of harmonics of the series.
    pub harmonics: usize,
    /// Share of the joints' speed limit that may be used.
    pub haste: f64,
    /// Time over which the motion swells from rest in mid-region and dies down again, s; 0: it starts and ends in motion.
    pub ease: f64,
}

impl Pace {
    /// Pace that is fast and slow in turn, as most sessions have it.
    pub fn lively() -> Self {
        Self {
            rate: 0.11,
            depth: 1.05,
            period: 7.5,
            harmonics: 6,
            haste: 0.8,
            ease: 0.0,
        }
    }

    /// Mostly slow, with many reversals at low speed.
    pub fn slow() -> Self {
        Self {
            rate: 0.045,
            depth: 1.1,
            period: 6.0,
            harmonics: 5,
            haste: 0.5,
            ease: 0.0,
        }
    }

    /// A plain Fourier series with this fundamental frequency, Hz.
    pub fn constant(rate: f64, harmonics: usize, haste: f64) -> Self {
        Self {
            rate,
            depth: 0.0,
            period: 1.0,
            harmonics,
            haste,
            ease: 0.0,
        }
    }
}

/// q_j = c_j + Σ_k A_jk sin(2πk s(t) + φ_jk).
#[derive(Debug, Clone)]
pub struct Multisine {
    centre: Vec<f64>,
    /// Amplitude and phase of each harmonic, joint after joint.
    waves: Vec<(f64, f64)>,
    harmonics: usize,
    pace: Pace,
    phase: f64,
    length: f64,
    /// Values of s at multiples of [`GRID`].
    progress: Vec<f64>,
}

/// Step of the table of s(t), s.
const GRID: f64 = 0.005;

impl Multisine {
    /// A random series within the arm's region and speeds, valid for `length` seconds.
    pub fn draw(arm: &Arm, pace: &Pace, length: f64, rng: &mut ChaCha8Rng) -> Self {
        let n = arm.dof();
        let mut pace = *pace;
        if pace.depth > 0.0 {
            pace.rate *= log_uniform(rng, 0.8, 1.25);
            pace.depth *= rng.random_range(0.75..1.2);
            pace.period *= rng.random_range(0.85..1.15);
        }
        let phase = rng.random_range(0.0..TAU);
        let mut waves = Vec::with_capacity(n * pace.harmonics);
        for _ in 0..n {
            for k in 1..=pace.harmonics {
                let amplitude = rng.random_range(0.2..1.0) / (k as f64).powf(0.8);
                waves.push((amplitude, rng.random_range(0.0..TAU)));
            }
        }
        let mut series = Self {
            centre: vec![0.0; n],
            waves,
            harmonics: pace.harmonics,
            pace,
            phase,
            length,
            progress: Vec::new(),
        };
        series.tabulate(length);
        series.fit_into(arm, length, rng);
        series
    }

    /// Scales every joint to its region and speed; where the speed limits its amplitude, shifts its centre at random.
    fn fit_into(&mut self, arm: &Arm, length: f64, rng: &mut ChaCha8Rng) {
        let n = arm.dof();
        let mut c = Command::new(n);
        let (mut top, mut speed) = (vec![0.0f64; n], vec![0.0f64; n]);
        let mut acceleration = vec![0.0f64; n];
        let mut t = 0.0;
        while t <= length {
            self.sample(t, &mut c);
            for j in 0..n {
                top[j] = top[j].max(c.q[j].abs());
                speed[j] = speed[j].max(c.qd[j].abs());
                acceleration[j] = acceleration[j].max(c.qdd[j].abs());
            }
            t += 0.01;
        }
        for j in 0..n {
            let reach = arm.reach[j] * rng.random_range(0.6..0.97);
            let limit =
                arm.joints[j].limits.velocity * self.pace.haste * rng.random_range(0.5..1.0);
            // Top speed is reached in no less than 0.15 s.
            let scale = (reach / top[j])
                .min(limit / speed[j])
                .min(limit / (0.15 * acceleration[j]));
            for wave in &mut self.waves[j * self.harmonics..][..self.harmonics] {
                wave.0 *= scale;
            }
            let spare = arm.reach[j] * 0.99 - scale * top[j];
            let aside = spare.max(0.0) * rng.random_range(-1.0..1.0);
            self.centre[j] = arm.centre[j] + if self.pace.ease > 0.0 { 0.0 } else { aside };
        }
    }

    /// Pace ds/dt and its derivative.
    fn pace_at(&self, t: f64) -> (f64, f64) {
        let w = TAU / self.pace.period;
        let (s, c) = (w * t + self.phase).sin_cos();
        let rate = self.pace.rate * (self.pace.depth * s).exp();
        (rate, rate * self.pace.depth * w * c)
    }

    /// Tabulates s(t) by Simpson's rule; its error in q is far below double precision of s.
    fn tabulate(&mut self, length: f64) {
        let steps = (length / GRID).ceil() as usize + 1;
        let mut s = 0.0;
        self.progress = (0..=steps)
            .map(|k| {
                let here = s;
                let t = k as f64 * GRID;
                let mid = self.pace_at(t + 0.5 * GRID).0;
                s += GRID / 6.0 * (self.pace_at(t).0 + 4.0 * mid + self.pace_at(t + GRID).0);
                here
            })
            .collect();
    }

    /// s(t), its derivative and second derivative.
    fn progress_at(&self, t: f64) -> (f64, f64, f64) {
        let (rate, change) = self.pace_at(t);
        let k = ((t / GRID) as usize).min(self.progress.len() - 1);
        // From the table's point by Simpson's rule again.
        let t0 = k as f64 * GRID;
        let h = t - t0;
        let part = h / 6.0 * (self.pace_at(t0).0 + 4.0 * self.pace_at(t0 + 0.5 * h).0 + rate);
        (self.progress[k] + part, rate, change)
    }

    /// Weight of the series at time `t` and its first two derivatives.
    fn weight(&self, t: f64) -> [f64; 3] {
        let ease = self.pace.ease;
        if ease <= 0.0 {
            return [1.0, 0.0, 0.0];
        }
        let (left, rising) = if t < 0.5 * self.length {
            (t, 1.0)
        } else {
            (self.length - t, -1.0)
        };
        let (p, v, a) = smooth_step((left / ease).clamp(0.0, 1.0));
        [p, rising * v / ease, a / (ease * ease)]
    }

    /// The command at time `t`, s.
    pub fn sample(&self, t: f64, out: &mut Command) {
        let (s, rate, change) = self.progress_at(t);
        let [w0, w1, w2] = self.weight(t);
        for (j, waves) in self.waves.chunks(self.harmonics).enumerate() {
            let (mut p, mut v, mut a) = (0.0, 0.0, 0.0);
            for (k, (amplitude, phase)) in waves.iter().enumerate() {
                let w = TAU * (k + 1) as f64;
                let (sin, cos) = (w * s + phase).sin_cos();
                p += amplitude * sin;
                v += amplitude * w * cos;
                a -= amplitude * w * w * sin;
            }
            let (v, a) = (v * rate, a * rate * rate + v * change);
            out.q[j] = self.centre[j] + w0 * p;
            out.qd[j] = w0 * v + w1 * p;
            out.qdd[j] = w0 * a + 2.0 * w1 * v + w2 * p;
        }
    }
}
