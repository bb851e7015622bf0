//! The forward baseline on recordings of any rate.

use super::LinearForward;
use super::settings::ForwardSettings;
use crate::baseline::BaselineError;
use datasets::Recording;
use datasets::metrics::{Row, ShapeError};
use ndarray::{Array2, Axis};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Name of the baseline's rows of scores.
pub const FORWARD: &str = "forward_baseline";

/// Sampling rate of the benchmark, Hz. Faster recordings are thinned to about this rate, so that the horizon
/// covers the same time and 1000 Hz cost no more than 10.
const RATE_HZ: f64 = 10.0;

/// Largest relative difference at which two sampling rates count as the same.
const SAME_RATE: f64 = 0.05;

/// Linear state space from torque to position, with the sampling rate of its fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ForwardBaseline {
    /// Sampling rate of the model, Hz, about 10.
    pub rate_hz: f64,
    /// Fitted state space with its normalisations.
    pub model: LinearForward,
}

/// Positions of a recording at the model's rate.
pub struct Simulated {
    /// Measured positions, rad (m), shape (samples at the model's rate, joints).
    pub measured: Array2<f64>,
    /// Simulated positions, rad (m), shape (samples at the model's rate, joints).
    pub simulated: Array2<f64>,
    /// Index of the recording's sample for each row.
    pub source: Vec<usize>,
    /// Range of rows of each trajectory.
    pub trajectories: Vec<Range<usize>>,
}

/// Recording thinned to about [`RATE_HZ`].
struct Thinned {
    rate_hz: f64,
    tau: Array2<f64>,
    q: Array2<f64>,
    /// Index of the recording's sample for each row.
    source: Vec<usize>,
    trajectories: Vec<Range<usize>>,
}

impl Thinned {
    /// Thins a recording; none without torque. Of every k samples the last one's position is kept, and the mean
    /// torque, which moved the joint there.
    fn of(recording: &Recording) -> Option<Self> {
        let tau = recording.tau.as_ref()?;
        let rate = recording.median_step().recip();
        let every = (rate / RATE_HZ).round().max(1.0) as usize;
        let mut source = Vec::new();
        let mut trajectories = Vec::new();
        for rows in recording.segments() {
            let first = source.len();
            source.extend((rows.start + every - 1..rows.end).step_by(every));
            trajectories.push(first..source.len());
        }
        let mean = |row: usize, joint: usize| {
            let sum: f64 = (row + 1 - every..=row).map(|r| tau[(r, joint)]).sum();
            sum / every as f64
        };
        Some(Self {
            rate_hz: rate / every as f64,
            tau: Array2::from_shape_fn((source.len(), tau.ncols()), |(k, j)| mean(source[k], j)),
            q: recording.q.select(Axis(0), &source),
            source,
            trajectories,
        })
    }

    fn has_rate(&self, rate_hz: f64) -> bool {
        (self.rate_hz / rate_hz - 1.0).abs() < SAME_RATE
    }
}

impl ForwardBaseline {
    /// Fits the state space of the KR300 benchmark paper (12 states for six joints) to the recordings with the sampling
    /// rate of the longest.
    ///
    /// # Errors
    /// No torque, or too few samples in unbroken stretches.
    pub fn fit(data: &[Recording]) -> Result<Self, BaselineError> {
        let thinned: Vec<Thinned> = data.iter().filter_map(Thinned::of).collect();
        let longest = thinned.iter().max_by_key(|t| t.source.len());
        let Some(rate_hz) = longest.map(|t| t.rate_hz) else {
            return Err(BaselineError::TooShort {
                found: 0,
                needed: 1,
            });
        };
        let used: Vec<&Thinned> = thinned.iter().filter(|t| t.has_rate(rate_hz)).collect();
        let stacked = |table: fn(&Thinned) -> &Array2<f64>| {
            let views: Vec<_> = used.iter().map(|t| table(t).view()).collect();
            ndarray::concatenate(Axis(0), &views).unwrap_or_default()
        };
        let mut trajectories = Vec::new();
        let mut start = 0;
        for part in &used {
            trajectories.extend(
                part.trajectories
                    .iter()
                    .map(|r| start + r.start..start + r.end),
            );
            start += part.source.len();
        }
        let (tau, q) = (stacked(|t| &t.tau), stacked(|t| &t.q));
        let settings = ForwardSettings::for_joints(q.ncols());
        Ok(Self {
            rate_hz,
            model: LinearForward::fit(tau.view(), q.view(), &trajectories, &settings)?,
        })
    }

    /// Positions simulated from the recorded torque beside the measured ones, in rad (m). None where the recording has no
    /// torque, another rate, or other joints.
    pub fn simulate(&self, recording: &Recording) -> Option<Simulated> {
        let thinned = Thinned::of(recording).filter(|t| t.has_rate(self.rate_hz))?;
        let simulated = self
            .model
            .simulate(thinned.tau.view(), &thinned.trajectories);
        Some(Simulated {
            simulated: simulated.ok()?,
            measured: thinned.q,
            source: thinned.source,
            trajectories: thinned.trajectories,
        })
    }

    /// Scores of [`ForwardBaseline::simulate`]. `qd`, shape (samples, joints), tells where joints move. None
    /// where there is nothing to score.
    ///
    /// # Errors
    /// Tables of different shapes.
    pub fn rows(
        &self,
        recording: &Recording,
        qd: &Array2<f64>,
    ) -> Result<Option<[Row; 2]>, ShapeError> {
        let Some(s) = self.simulate(recording) else {
            return Ok(None);
        };
        let speed = qd.select(Axis(0), &s.source);
        Row::both_scopes(FORWARD, &s.measured, &s.simulated, &speed).map(Some)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two joints, each a damped mass that follows its own torque, at `rate` Hz for 80 s.
    fn recording(rate: f64, seed: f64) -> Recording {
        let n = (80.0 * rate) as usize;
        let dt = 1.0 / rate;
        let (mut q, mut tau) = (Array2::zeros((n, 2)), Array2::zeros((n, 2)));
        for joint in 0..2 {
            let (mut x, mut v) = (0.0, 0.0);
            for k in 0..n {
                let t = k as f64 * dt;
                // A new level every 0.3 s, so that every frequency is there.
                let level = (t / 0.3).floor() * 12.9898 + seed + 78.233 * joint as f64;
                let u = (level.sin() * 43758.5453).fract();
                // Spring, damper, mass: q settles under its torque.
                for _ in 0..10 {
                    v += 0.1 * dt * (u - 2.0 * x - 1.5 * v);
                    x += 0.1 * dt * v;
                }
                (q[(k, joint)], tau[(k, joint)]) = (x, u);
            }
        }
        let time = (0..n).map(|k| k as f64 * dt).collect();
        Recording::new("made", time, q, Some(tau))
    }

    #[test]
    fn a_linear_plant_is_followed_at_any_rate() {
        let model = ForwardBaseline::fit(&[recording(100.0, 0.1)]).unwrap();
        assert!((model.rate_hz - 10.0).abs() < 1e-6);
        for rate in [100.0, 10.0, 50.0] {
            let other = recording(rate, 0.4);
            let qd = Array2::ones(other.q.dim());
            let [all, _] = model.rows(&other, &qd).unwrap().unwrap();
            assert_eq!(all.name, FORWARD);
            assert!(all.scores.mean_nrmse.unwrap() < 0.2, "{rate} Hz: {all:?}");
        }
        let slow = recording(4.0, 0.4);
        assert!(
            model
                .rows(&slow, &Array2::ones(slow.q.dim()))
                .unwrap()
                .is_none()
        );
    }
}
