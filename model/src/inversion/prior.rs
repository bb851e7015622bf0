//! Prior on motions: shapes of the training trajectories, sample by sample from their start.

use super::error::InversionError;
use datasets::Recording;
use datasets::metrics::MOVING;
use faer::Mat;
use ndarray::Array2;
use serde::{Deserialize, Serialize};
use signal::spline::Spline;
use std::collections::BTreeMap;

/// Largest part of the squared motion that the shapes may leave undescribed.
const LEFT: f64 = 1e-5;
/// Least number of recorded joint motions for each shape. With fewer, the shapes would be those very motions.
const MOTIONS_BY_SHAPE: usize = 4;
/// Fewest samples for a quintic spline.
const LEAST: usize = 6;
/// Largest relative difference at which two sampling rates count as the same.
const SAME_RATE: f64 = 0.01;

/// Prior on motions: shapes over time, learned from the training trajectories.
///
/// The position of a joint less its start is `scale` · Σ coefficient · shape. The coefficients are independent, with
/// mean 0 and the standard deviation `deviation`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionPrior {
    /// Sampling rate of the shapes, Hz.
    pub rate_hz: f64,
    /// Root mean square distance of each joint from its start, rad (m).
    pub scale: Vec<f64>,
    /// Shapes, each over the samples of a trajectory; orthonormal.
    pub shapes: Vec<Vec<f64>>,
    /// Standard deviation of each shape's coefficient over motions and joints.
    pub deviation: Vec<f64>,
    /// Share of the training motions that are at standstill, for each sample of a trajectory.
    pub standing: Vec<f64>,
}

/// Shapes and their derivatives: tables of shape (samples, shapes).
pub(super) struct Shapes {
    /// Values of the shapes, without unit.
    pub q: Array2<f64>,
    /// First derivatives by time, 1/s.
    pub qd: Array2<f64>,
    /// Second derivatives by time, 1/s².
    pub qdd: Array2<f64>,
}

impl MotionPrior {
    /// Learns the shapes from the trajectories of the most common length, in recordings with the rate of the
    /// first. `qd` are the joints' velocities at the samples.
    ///
    /// # Errors
    /// Too few such trajectories for the number of shapes that they are made of.
    pub fn learn(data: &[(&Recording, &Array2<f64>)]) -> Result<Self, InversionError> {
        let mut lengths: BTreeMap<usize, usize> = BTreeMap::new();
        let (first, _) = data.first().ok_or(InversionError::NoTrajectory)?;
        let rate_hz = first.median_step().recip();
        let same = |r: &Recording| (r.median_step() * rate_hz - 1.0).abs() < SAME_RATE;
        let data: Vec<_> = data.iter().filter(|(r, _)| same(r)).collect();
        let ranges = |r: &Recording| r.segments().into_iter().map(|s| s.len());
        for length in data.iter().flat_map(|(r, _)| ranges(r)) {
            *lengths.entry(length).or_default() += 1;
        }
        let commonest = lengths
            .iter()
            .filter(|&(&length, _)| length >= LEAST)
            .max_by_key(|&(length, count)| (count, length));
        let (&samples, &trajectories) = commonest.ok_or(InversionError::NoTrajectory)?;
        let joints = first.dof();

        let mut motions: Vec<(usize, Vec<f64>)> = Vec::new();
        let mut standing = vec![0.0; samples];
        for (recording, qd) in data {
            for rows in recording
                .segments()
                .into_iter()
                .filter(|s| s.len() == samples)
            {
                for joint in 0..joints {
                    let q = recording.q.column(joint);
                    let motion = rows.clone().map(|r| q[r] - q[rows.start]).collect();
                    motions.push((joint, motion));
                    for (share, row) in standing.iter_mut().zip(rows.clone()) {
                        *share += f64::from(u8::from(qd[[row, joint]].abs() < MOVING));
                    }
                }
            }
        }
        standing.iter_mut().for_each(|s| *s /= motions.len() as f64);
        let mut scale = vec![0.0; joints];
        for (joint, motion) in &motions {
            scale[*joint] += motion.iter().map(|v| v * v).sum::<f64>();
        }
        let count = (motions.len() / joints * samples) as f64;
        for s in &mut scale {
            *s = (*s / count).sqrt();
            if *s < MOVING / rate_hz {
                return Err(InversionError::Still);
            }
        }

        let table = Mat::from_fn(motions.len(), samples, |m, k| {
            let (joint, motion) = &motions[m];
            motion[k] / scale[*joint]
        });
        let svd = table
            .thin_svd()
            .map_err(|_| InversionError::Decomposition)?;
        let sizes: Vec<f64> = svd.S().column_vector().iter().copied().collect();
        let total: f64 = sizes.iter().map(|s| s * s).sum();
        let mut left = total;
        let mut kept = 0;
        while left > LEFT * total && kept < sizes.len() {
            left -= sizes[kept] * sizes[kept];
            kept += 1;
        }
        if motions.len() < MOTIONS_BY_SHAPE * kept {
            return Err(InversionError::TooFew {
                trajectories,
                shapes: kept,
                needed: (MOTIONS_BY_SHAPE * kept).div_ceil(joints),
            });
        }
        let all = (motions.len() as f64).sqrt();
        Ok(Self {
            rate_hz,
            scale,
            shapes: (0..kept)
                .map(|k| (0..samples).map(|i| svd.V()[(i, k)]).collect())
                .collect(),
            deviation: sizes[..kept].iter().map(|s| s / all).collect(),
            standing,
        })
    }

    /// Number of samples of the longest trajectory.
    pub fn samples(&self) -> usize {
        self.standing.len()
    }

    /// Whether a recording has the shapes' sampling rate, and no longer trajectory than they have.
    pub fn covers(&self, recording: &Recording) -> bool {
        let rate = (recording.median_step() * self.rate_hz - 1.0).abs() < SAME_RATE;
        let long = |s: std::ops::Range<usize>| s.len() > self.samples();
        rate && recording.dof() == self.scale.len() && !recording.segments().into_iter().any(long)
    }

    /// Values and derivatives of the shapes, by a quintic spline.
    ///
    /// # Errors
    /// Shapes of fewer than six samples.
    pub(super) fn sampled(&self) -> Result<Shapes, InversionError> {
        let time: Vec<f64> = (0..self.samples())
            .map(|k| k as f64 / self.rate_hz)
            .collect();
        let empty = || Array2::zeros((time.len(), self.shapes.len()));
        let [mut q, mut qd, mut qdd] = [empty(), empty(), empty()];
        for (k, shape) in self.shapes.iter().enumerate() {
            let spline = Spline::quintic(&time, shape).map_err(|_| InversionError::NoTrajectory)?;
            for (row, &t) in time.iter().enumerate() {
                [q[[row, k]], qd[[row, k]], qdd[[row, k]]] = spline.at(t);
            }
        }
        Ok(Shapes { q, qd, qdd })
    }
}
