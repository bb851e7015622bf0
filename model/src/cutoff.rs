//! Cut-off of the motion's low-pass, chosen by what it does to the torque.
//!
//! The noise of a position says little about the cut-off: what counts is whether q̈ at that cut-off still explains
//! torque. So the basic model (rigid body, viscous and soft Coulomb friction, offset, rotor inertia) is fitted to the
//! raw recorded torque at a few cut-offs, and the error on rows left out decides. Nothing of a held-out recording is
//! looked at.

use crate::basic;
use crate::design::{Data, rigid_columns};
use crate::identification::{IdentifyError, Target};
use crate::session::Session;
use datasets::check::moves;
use datasets::prepare::{Derivatives, PrepareError, PrepareOptions, prepare};
use datasets::{Folds, Recording};
use ndarray::Array2;
use physics::identify::base::BaseParameters;
use physics::robot::Robot;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Lowest and highest cut-off tried, Hz; the highest is also at most this part of the rate.
const RANGE_HZ: [f64; 2] = [1.5, 100.0];
/// Highest cut-off that a rate carries, as a part of the rate.
pub const HIGHEST_PART: f64 = 0.4;
/// Ratio of neighbouring cut-offs of the first look.
const RATIO: f64 = 1.5;
/// Errors within this part of the least are as good as it: the middle of such a stretch is taken.
const ALIKE: f64 = 0.003;
/// Samples looked at, at most: whole trajectories, evenly spread.
const SAMPLES: usize = 40_000;
/// Rows fitted, at most.
const ROWS: usize = 5000;
/// Folds of the search.
const FOLDS: usize = 6;
/// Time that a residual remembers, s: rows closer to a fold are not fitted.
const MEMORY: f64 = 0.5;

/// One cut-off that was tried.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tried {
    /// Cut-off, Hz.
    pub cutoff_hz: f64,
    /// Mean over joints of the basic model's NRMSE on rows left out.
    pub error: f64,
}

/// How the cut-off was chosen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CutoffChoice {
    /// What was tried, lowest first, with recorded velocity fused in where it fits.
    pub tried: Vec<Tried>,
    /// The same at the cut-off taken from position alone, where a velocity was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_alone: Option<Tried>,
}

/// The options with the cut-off that explains the torque of `data` best, and how it was chosen; as they are where a
/// cut-off is given, where the recordings are too slow for a low-pass, and where nothing can be left out.
///
/// # Errors
/// Recordings that cannot be prepared, or not fitted.
pub fn choose(
    robot: &Robot,
    data: &[Recording],
    options: &PrepareOptions,
) -> Result<(PrepareOptions, Option<CutoffChoice>), CutoffError> {
    let slowest = data
        .iter()
        .map(|r| 1.0 / r.median_step())
        .fold(f64::INFINITY, f64::min);
    let fits = data
        .iter()
        .all(|r| r.dof() == robot.dof() && r.tau.is_some());
    if options.cutoff_hz.is_some() || !fits || !options.low_passes(slowest) {
        return Ok((*options, None));
    }
    let sample = sample_of(data);
    let search = Search::new(robot, &sample, options);
    let highest = (HIGHEST_PART * slowest).min(RANGE_HZ[1]);
    let lowest = RANGE_HZ[0].min(0.5 * highest);
    let steps = ((highest / lowest).ln() / RATIO.ln()).ceil() as usize;
    let grid: Vec<f64> = (0..=steps)
        .map(|k| lowest * (highest / lowest).powf(k as f64 / steps as f64))
        .collect();
    let mut tried = search.errors(&grid, Derivatives::Auto)?;
    let Some(best) = least(&tried) else {
        return Ok((*options, None));
    };
    let between: Vec<f64> = [best.checked_sub(1), Some(best + 1)]
        .into_iter()
        .flatten()
        .filter_map(|k| Some((tried.get(k)?.cutoff_hz * tried[best].cutoff_hz).sqrt()))
        .collect();
    tried.extend(search.errors(&between, Derivatives::Auto)?);
    tried.sort_by(|a, b| a.cutoff_hz.total_cmp(&b.cutoff_hz));
    let Some(cutoff_hz) = middle(&tried) else {
        return Ok((*options, None));
    };
    let mut chosen = PrepareOptions {
        cutoff_hz: Some(cutoff_hz),
        ..*options
    };
    let mut position_alone = None;
    if options.derivatives == Derivatives::Auto && data.iter().all(|r| r.qd.is_some()) {
        let fused = search.errors(&[cutoff_hz], Derivatives::Auto)?;
        let alone = search.errors(&[cutoff_hz], Derivatives::FromPosition)?;
        if let (Some(fused), Some(alone)) = (fused.first(), alone.first()) {
            position_alone = Some(*alone);
            if alone.error < fused.error * (1.0 - ALIKE) {
                chosen.derivatives = Derivatives::FromPosition;
            }
        }
    }
    Ok((
        chosen,
        Some(CutoffChoice {
            tried,
            position_alone,
        }),
    ))
}

/// Whether the basic model explains the torque of `data` better out of fold with one way of preparing than with another.
///
/// # Errors
/// As [`choose`].
pub fn explains_better(
    robot: &Robot,
    data: &[Recording],
    one: &PrepareOptions,
    other: &PrepareOptions,
) -> Result<bool, CutoffError> {
    let sample = sample_of(data);
    let error = |options: &PrepareOptions| Search::new(robot, &sample, options).error(options);
    let both = (error(one)?, error(other)?);
    Ok(matches!(both, (Some(one), Some(other)) if one < other * (1.0 - ALIKE)))
}

/// Part of the recordings that is looked at.
fn sample_of(data: &[Recording]) -> Vec<Recording> {
    let share = SAMPLES / data.len().max(1);
    data.iter().map(|r| part_of(r, share)).collect()
}

/// The options for one recording: a cut-off that its rate cannot carry becomes the highest that it can.
pub fn for_recording(options: &PrepareOptions, recording: &Recording) -> PrepareOptions {
    let highest = HIGHEST_PART / recording.median_step();
    PrepareOptions {
        cutoff_hz: options.cutoff_hz.map(|hz| hz.min(highest)),
        ..*options
    }
}

/// Time around a block of rows that is left out together with it, s: the reach of the low-pass and of the residual.
pub fn gap(options: &PrepareOptions) -> f64 {
    options.cutoff_hz.map_or(MEMORY, |hz| MEMORY.max(1.0 / hz))
}

/// Why no cut-off could be chosen.
#[derive(Debug, thiserror::Error)]
pub enum CutoffError {
    /// A recording cannot be prepared.
    #[error("{file}: {source}")]
    Prepare {
        /// The recording.
        file: String,
        /// Why.
        source: PrepareError,
    },
    /// The basic model cannot be fitted.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
}

/// What the search is made on.
struct Search<'a> {
    robot: &'a Robot,
    base: BaseParameters,
    recordings: Vec<&'a Recording>,
    options: &'a PrepareOptions,
}

impl<'a> Search<'a> {
    fn new(robot: &'a Robot, sample: &'a [Recording], options: &'a PrepareOptions) -> Self {
        Self {
            robot,
            base: BaseParameters::of_robot(robot, &[]),
            recordings: sample.iter().collect(),
            options,
        }
    }

    /// Errors at several cut-offs; those at which nothing could be fitted are left out.
    fn errors(&self, cutoffs: &[f64], from: Derivatives) -> Result<Vec<Tried>, CutoffError> {
        let tried = cutoffs.par_iter().map(|&cutoff_hz| {
            let error = self.error(&PrepareOptions {
                cutoff_hz: Some(cutoff_hz),
                derivatives: from,
                ..*self.options
            })?;
            Ok(error.map(|error| Tried { cutoff_hz, error }))
        });
        let tried: Vec<Option<Tried>> = tried.collect::<Result<_, CutoffError>>()?;
        Ok(tried.into_iter().flatten().collect())
    }

    fn error(&self, options: &PrepareOptions) -> Result<Option<f64>, CutoffError> {
        let prepared = |r: &&Recording| {
            prepare(r, &for_recording(options, r)).map_err(|source| CutoffError::Prepare {
                file: r.source.clone(),
                source,
            })
        };
        let parts = self
            .recordings
            .iter()
            .map(prepared)
            .collect::<Result<_, _>>()?;
        let session = Session::new(parts, &[]);
        let target = Target {
            tau: self
                .recordings
                .iter()
                .filter_map(|r| r.tau.as_ref())
                .collect(),
            folds: Folds::new(&self.recordings, FOLDS, gap(options)),
        };
        let samples: usize = self.recordings.iter().map(|r| r.len()).sum();
        let every = samples.div_ceil(ROWS).max(1);
        let all = 0..self.recordings.len();
        let rigid = rigid_columns(self.robot, &self.base, &session, all, every);
        let data = Data {
            robot: self.robot,
            base: &self.base,
            rigid: &rigid,
            session: &session,
            target: &target,
            moving_only: false,
            every,
        };
        let terms = basic::softened(&basic::terms(self.robot), basic::USUAL_SOFTNESS);
        let no_load: Vec<Array2<f64>> = session
            .parts
            .iter()
            .map(|p| Array2::zeros(p.fine.q.dim()))
            .collect();
        let rmse = basic::out_of_fold(&data, &terms, &no_load).map_err(IdentifyError::from)?;
        Ok(rmse.and_then(|rmse| self.mean_nrmse(&rmse)))
    }

    /// Mean over joints that move of error over the torque's deviation.
    fn mean_nrmse(&self, rmse: &[f64]) -> Option<f64> {
        let (mut sum, mut count) = (0.0, 0);
        for (joint, rmse) in rmse.iter().enumerate() {
            let moves = self.recordings.iter().any(|r| moves(r, joint));
            let (mut n, mut mean, mut squares) = (0.0, 0.0, 0.0);
            for tau in self.recordings.iter().filter_map(|r| r.tau.as_ref()) {
                for t in tau.column(joint) {
                    n += 1.0;
                    let apart = t - mean;
                    mean += apart / n;
                    squares += apart * (t - mean);
                }
            }
            let deviation = f64::sqrt(squares / n);
            if moves && deviation > 0.0 && rmse.is_finite() {
                sum += rmse / deviation;
                count += 1;
            }
        }
        (count > 0).then(|| sum / f64::from(count))
    }
}

fn least(tried: &[Tried]) -> Option<usize> {
    (0..tried.len()).min_by(|&a, &b| tried[a].error.total_cmp(&tried[b].error))
}

/// Middle, in logarithm, of the cut-offs around the best one whose errors are as good.
fn middle(tried: &[Tried]) -> Option<f64> {
    let best = least(tried)?;
    let alike = |t: &Tried| t.error <= tried[best].error * (1.0 + ALIKE);
    let first = (0..=best).rev().take_while(|&k| alike(&tried[k])).last()?;
    let last = (best..tried.len())
        .take_while(|&k| alike(&tried[k]))
        .last()?;
    Some((tried[first].cutoff_hz * tried[last].cutoff_hz).sqrt())
}

/// Some of a recording's trajectories, evenly spread, with about so many samples; the beginning of a single longer one.
fn part_of(recording: &Recording, samples: usize) -> Recording {
    let count = recording.trajectories.len();
    let every = recording
        .len()
        .div_ceil(samples.max(1))
        .clamp(1, count.max(1));
    let mut rows: Vec<(usize, std::ops::Range<usize>)> = Vec::new();
    let mut left = samples.max(1);
    for (index, trajectory) in recording.trajectories.iter().enumerate().step_by(every) {
        let range = trajectory.range.clone();
        let take = range.len().min(left);
        // What is left of a budget is no trajectory.
        if take < range.len() && !rows.is_empty() {
            break;
        }
        rows.push((index, range.start..range.start + take));
        left -= take;
    }
    recording.stretches(&rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tried(list: &[(f64, f64)]) -> Vec<Tried> {
        let of = |&(cutoff_hz, error): &(f64, f64)| Tried { cutoff_hz, error };
        list.iter().map(of).collect()
    }

    #[test]
    fn the_middle_of_what_is_as_good_as_the_best() {
        // Flat from 4 to 16 Hz: 8 Hz. The dip far away is as good, but not joined to the best.
        let flat = [
            (2.0, 0.2),
            (4.0, 0.1002),
            (8.0, 0.1),
            (16.0, 0.1001),
            (32.0, 0.3),
            (64.0, 0.1),
        ];
        assert_eq!(middle(&tried(&flat)), Some(8.0));
        assert_eq!(
            middle(&tried(&[(3.0, 0.2), (5.0, 0.1), (9.0, 0.4)])),
            Some(5.0)
        );
        assert_eq!(middle(&[]), None);
    }
}
