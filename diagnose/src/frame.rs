//! A recording on the clocks that the analysis uses.

use crate::scene::Scale;
use datasets::Recording;
use ndarray::{Array1, Array2};
use signal::Motion;
use signal::filter::filtfilt;
use signal::sos::{Section, butterworth};
use std::ops::Range;

/// Rate of the rows that are fitted, Hz: no effect but ripple lives above a third of it.
const ANALYSIS_RATE: f64 = 62.5;

/// A recording's motion at the fine rate, its torque as recorded, and the way from one to rows that
/// are fitted.
pub struct Frame {
    /// Filtered motion at the fine rate.
    pub motion: Motion,
    /// Recorded torque at the recorded samples, shape (samples, joints).
    pub tau: Array2<f64>,
    /// Recorded samples of each trajectory.
    pub segments: Vec<Range<usize>>,
    /// Rows that are fitted, by trajectory.
    pub rows: Vec<Range<usize>>,
    lowpass: Vec<Section>,
    stride: usize,
}

impl Frame {
    /// Prepares a recording whose torque is present.
    pub fn new(recording: &Recording, tau: Array2<f64>) -> Self {
        let step = recording.median_step();
        let rate = 1.0 / step;
        let segments = recording.segments();
        let stride = ((rate / ANALYSIS_RATE).round() as usize).max(1);
        let cutoff = (0.4 * rate / stride as f64).min(25.0);
        let lowpass = butterworth(4, cutoff, rate).expect("the cut-off lies below half the rate");
        let mut motion = Motion {
            time: recording.time.clone(),
            segments: segments.clone(),
            q: recording.q.clone(),
            qd: Array2::zeros(recording.q.dim()),
            qdd: Array2::zeros(recording.q.dim()),
        };
        for s in &segments {
            for j in 0..recording.dof() {
                let raw: Vec<f64> = s.clone().map(|i| recording.q[[i, j]]).collect();
                let q = filtfilt(&lowpass, &raw);
                let time = &recording.time[s.clone()];
                let qd = signal::differences::differences(time, &q);
                let qdd = signal::differences::differences(time, &qd);
                for (k, i) in s.clone().enumerate() {
                    motion.q[[i, j]] = q[k];
                    motion.qd[[i, j]] = qd[k];
                    motion.qdd[[i, j]] = qdd[k];
                }
            }
        }
        let mut rows = Vec::new();
        let mut start = 0;
        for s in &segments {
            let n = s.len().div_ceil(stride);
            rows.push(start..start + n);
            start += n;
        }
        Self { motion, tau, segments, rows, lowpass, stride }
    }

    /// Number of rows that are fitted.
    pub fn len(&self) -> usize {
        self.rows.last().map_or(0, |r| r.end)
    }

    /// True when there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A torque at the recorded samples on the rows that are fitted: low-passed within each
    /// trajectory, then thinned out.
    pub fn thin(&self, samples: &[f64]) -> Array1<f64> {
        let mut out = Vec::with_capacity(self.len());
        for s in &self.segments {
            let smooth = filtfilt(&self.lowpass, &samples[s.clone()]);
            out.extend(smooth.into_iter().step_by(self.stride));
        }
        Array1::from(out)
    }

    /// Values at the fine rate on the recorded samples.
    pub fn to_samples(&self, fine: Array1<f64>) -> Array1<f64> {
        fine
    }

    /// A column at the fine rate on the rows that are fitted.
    pub fn reduce(&self, fine: Array1<f64>) -> Array1<f64> {
        let samples = self.to_samples(fine);
        self.thin(samples.as_slice().expect("a vector in standard layout"))
    }

    /// Sizes for grids of shape parameters; `others` are recordings of the same session.
    pub fn scale(&self, others: &[&Frame]) -> Scale {
        let rms = |x: ndarray::ArrayView1<f64>| (x.dot(&x) / x.len() as f64).sqrt().max(1e-9);
        let times = || std::iter::once(self).chain(others.iter().copied()).flat_map(|f| f.motion.time.iter());
        Scale {
            speed: self.motion.qd.columns().into_iter().map(rms).collect(),
            range: self
                .motion
                .q
                .columns()
                .into_iter()
                .map(|q| q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x))))
                .collect(),
            torque: self.tau.columns().into_iter().map(rms).collect(),
            session: (times().fold(f64::INFINITY, |a, &t| a.min(t)), times().fold(f64::NEG_INFINITY, |a, &t| a.max(t))),
            step: self.motion.time.get(1).map_or(0.01, |t| t - self.motion.time[0]),
        }
    }
}
