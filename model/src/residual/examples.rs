//! Training examples of the units: rows of the training recordings in sequences, with the physics' residual.

use super::{Pace, ResidualError, companions, waves};
use crate::physics_fit::Fit;
use datasets::Recording;
use datasets::metrics::MOVING;
use feedforward::inputs::{Input, Signal};
use ndarray::{Array1, Array2, Axis};
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::ops::Range;

/// Quantile of a joint's speeds in motion that counts as a fast one.
const FAST: f64 = 0.9;
/// Most rows from which companions are chosen: smooth functions need no more, and time grows with them.
const CHOSEN_FROM: usize = 6000;

/// Rows of all training recordings, concatenated.
pub(super) struct Examples {
    /// Index of each recording, and its rows in the order of its sequences.
    pub rows: Vec<(usize, Vec<usize>)>,
    /// Ranges of the sequences; no window crosses their ends.
    pub segments: Vec<Range<usize>>,
    /// Index of the fold of each sequence.
    pub folds: Vec<usize>,
    /// Residual torque of the physics by joint, N·m.
    pub targets: Vec<Array1<f32>>,
    /// Weight of each sample by joint: 0 where it is not used.
    pub weights: Vec<Array1<f32>>,
}

impl Examples {
    /// Examples of recordings at about `period`, s, or faster. Faster ones are split into several sequences, so
    /// that windows keep their length in time.
    pub fn new(fit: &Fit, data: &[Recording], period: f64, moving_only: bool) -> Self {
        let joints = fit.file.joints.len();
        let mut made = Self {
            rows: Vec::new(),
            segments: Vec::new(),
            folds: Vec::new(),
            targets: Vec::new(),
            weights: Vec::new(),
        };
        let mut start = 0;
        for i in 0..data.len() {
            let part = &fit.session.parts[i];
            let Some(pace) = Pace::new(part.report.rate_hz, period) else {
                continue;
            };
            let (order, phases) = pace.rows(&part.at_samples.segments);
            let lengths = part.at_samples.segments.iter().map(ExactSizeIterator::len);
            for (fold, length) in fit.fold[i].iter().zip(lengths) {
                let count = pace.phases().min(length);
                made.folds.extend(std::iter::repeat_n(*fold, count));
            }
            let moved = phases.iter().map(|s| start + s.start..start + s.end);
            made.segments.extend(moved);
            start += order.len();
            made.rows.push((i, order));
        }
        for joint in 0..joints {
            let mut weight = Vec::new();
            for (i, order) in &made.rows {
                let qd = fit.session.parts[*i].at_samples.qd.column(joint);
                let counts = |&r: &usize| f32::from(u8::from(!moving_only || qd[r].abs() > MOVING));
                weight.extend(order.iter().map(counts));
            }
            made.targets.push(made.left(data, &fit.physics, joint));
            made.weights.push(weight.into());
        }
        made
    }

    /// Residual of a joint's torque beside `physics`, the torque at the samples of each recording, N·m.
    pub fn left(&self, data: &[Recording], physics: &[Array2<f64>], joint: usize) -> Array1<f32> {
        let of = |&(part, row): &(usize, usize)| {
            let tau = data[part]
                .tau
                .as_ref()
                .map_or(f64::NAN, |t| t[[row, joint]]);
            (tau - physics[part][[row, joint]]) as f32
        };
        self.places().iter().map(of).collect()
    }

    /// Number of rows of all recordings.
    pub fn len(&self) -> usize {
        self.segments.last().map_or(0, |s| s.end)
    }

    /// Rows of these examples from tables with one row per sample of each recording.
    pub fn of(&self, tables: &[Array2<f32>]) -> Array2<f32> {
        let blocks: Vec<Array2<f32>> = self
            .rows
            .iter()
            .map(|(i, order)| tables[*i].select(Axis(0), order))
            .collect();
        let views: Vec<_> = blocks.iter().map(|t| t.view()).collect();
        ndarray::concatenate(Axis(0), &views).unwrap_or_default()
    }

    /// Recording and sample of each row of the examples.
    pub fn places(&self) -> Vec<(usize, usize)> {
        let of = |(i, order): &(usize, Vec<usize>)| {
            let i = *i;
            order.clone().into_iter().map(move |r| (i, r))
        };
        self.rows.iter().flat_map(of).collect()
    }

    fn fold_of_rows(&self) -> Vec<usize> {
        let each = self.segments.iter().zip(&self.folds);
        each.flat_map(|(segment, &fold)| std::iter::repeat_n(fold, segment.len()))
            .collect()
    }

    /// Positions and velocities of other joints that each joint's residual follows.
    pub fn companions(&self, fit: &Fit) -> Result<Vec<Vec<Input>>, ResidualError> {
        let step = self.len().div_ceil(CHOSEN_FROM).max(1);
        let fold: Vec<usize> = self.fold_of_rows().into_iter().step_by(step).collect();
        let places: Vec<(usize, usize)> = self.places().into_iter().step_by(step).collect();
        let joints = self.targets.len();
        let motion = Array2::from_shape_fn((places.len(), 2 * joints), |(row, column)| {
            let (part, sample) = places[row];
            let motion = &fit.session.parts[part].at_samples;
            let table = if column < joints {
                &motion.q
            } else {
                &motion.qd
            };
            table[[sample, column % joints]]
        });
        let rows = companions::Rows::new(motion, &fold);
        let of = |(joint, left): (usize, &Array1<f32>)| {
            let left: Vec<f64> = left.iter().step_by(step).map(|l| f64::from(*l)).collect();
            let followed = rows.followed(joint, &left)?;
            let input = |column: usize| Input {
                joint: column % joints,
                signal: [Signal::Position, Signal::Velocity][column / joints].clone(),
            };
            Ok(followed.into_iter().map(input).collect())
        };
        self.targets.iter().enumerate().map(of).collect()
    }

    /// Orders of the torque that is periodic in each joint's position. The highest is the one that the torque's
    /// channel passes at nearly all speeds of the joint.
    pub fn waves(&self, fit: &Fit) -> Vec<Vec<f64>> {
        let fold_of_row = self.fold_of_rows();
        let places = self.places();
        let of = |joint: usize| {
            let rows = places.iter().zip(&self.targets[joint]).zip(&fold_of_row);
            let seen: Vec<waves::Seen> = rows
                .filter_map(|((&(part, row), left), &fold)| {
                    let motion = &fit.session.parts[part].at_samples;
                    let moves = motion.qd[[row, joint]].abs() > MOVING;
                    moves.then(|| waves::Seen {
                        position: motion.q[[row, joint]],
                        left: f64::from(*left),
                        fold,
                    })
                })
                .collect();
            waves::orders(&seen, self.highest(fit, joint))
        };
        (0..self.targets.len()).into_par_iter().map(of).collect()
    }

    /// Highest order that the recorded torque can show, in periods per 2π of position.
    fn highest(&self, fit: &Fit, joint: usize) -> f64 {
        let band = |(part, _): &(usize, Vec<usize>)| {
            let report = &fit.session.parts[*part].report;
            let rate = 0.5 * report.rate_hz;
            report.torque_filter.map_or(rate, |f| rate.min(f.cutoff_hz))
        };
        let lowest = self.rows.iter().map(band).fold(f64::INFINITY, f64::min);
        let speeds = self.rows.iter().flat_map(|(part, order)| {
            let qd = fit.session.parts[*part].at_samples.qd.column(joint);
            order.iter().map(move |&r| qd[r].abs())
        });
        let mut moving: Vec<f64> = speeds.filter(|&v| v > MOVING).collect();
        moving.sort_by(f64::total_cmp);
        let fast = moving.get((FAST * moving.len() as f64) as usize).copied();
        fast.map_or(0.0, |v| TAU * lowest / v)
    }
}
