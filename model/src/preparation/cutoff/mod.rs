//! Cut-off of the motion's low-pass, chosen by the error of the torque.
//!
//! The noise of a position does not determine the cut-off: q̈ must still explain the torque. So rigid body,
//! rotor inertia and friction of flexible shape are fitted to the raw recorded torque at a few cut-offs, and
//! the error on rows left out decides. Of the cut-offs that differ from the best by no more than chance the
//! middle is taken. No held-out recording is used.

mod error;
mod friction;
mod rate;
mod unseen;

use datasets::Recording;
use datasets::prepare::{Derivatives, PrepareOptions};
pub use error::CutoffError;
use physics::robot::Robot;
pub use rate::{HIGHEST_PART, for_recording};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use unseen::{Search, Unseen};

/// Lowest and highest cut-off that is tried, Hz; the highest is also limited to [`HIGHEST_PART`] of the rate.
const RANGE_HZ: [f64; 2] = [1.5, 100.0];
/// Ratio of neighbouring cut-offs in the first search.
const RATIO: f64 = 1.5;
/// Number of standard errors of their difference up to which two errors count as equal. Of a stretch of cut-offs with
/// equal errors the middle is taken.
const CHANCE: f64 = 1.0;
/// Largest number of samples that are used: whole trajectories, evenly spread.
const SAMPLES: usize = 40_000;
/// Autocorrelation time of a residual, s: rows closer to a fold are not fitted.
const MEMORY: f64 = 0.5;

/// Cut-off that was tried, with its error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tried {
    /// Cut-off that was tried, Hz.
    pub cutoff_hz: f64,
    /// Mean over joints of the NRMSE of rigid body and friction on rows left out.
    pub error: f64,
}

/// Chosen cut-off, and all that were tried.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CutoffChoice {
    /// Cut-offs that were tried, lowest first, with recorded velocity fused in where it fits.
    pub tried: Vec<Tried>,
    /// Error with derivatives from position alone at the chosen cut-off, where a velocity was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_alone: Option<Tried>,
}

/// Options with the cut-off that explains the torque of `data` best, and the choice. The options are unchanged
/// where a cut-off is given, where the recordings are too slow for a low-pass, and where no rows can be left
/// out.
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
    let search = search(robot, &sample);
    let highest = (HIGHEST_PART * slowest).min(RANGE_HZ[1]);
    let lowest = RANGE_HZ[0].min(0.5 * highest);
    let steps = ((highest / lowest).ln() / RATIO.ln()).ceil() as usize;
    let grid: Vec<f64> = (0..=steps)
        .map(|k| lowest * (highest / lowest).powf(k as f64 / steps as f64))
        .collect();
    let tried = errors(&search, &grid, options)?;
    let (cutoffs, unseen): (Vec<f64>, Vec<Unseen>) = tried.into_iter().unzip();
    let error: Vec<f64> = unseen.iter().map(Unseen::error).collect();
    let Some(best) = least(&error) else {
        return Ok((*options, None));
    };
    let cutoff_hz = middle(&cutoffs, best, |k| unseen[k].above(&unseen[best]) < CHANCE);
    let mut chosen = PrepareOptions {
        cutoff_hz: Some(cutoff_hz),
        ..*options
    };
    let mut position_alone = None;
    if options.derivatives == Derivatives::Auto && data.iter().all(|r| r.qd.is_some()) {
        let from_position = PrepareOptions {
            derivatives: Derivatives::FromPosition,
            ..chosen
        };
        if let (Some(fused), Some(alone)) =
            (search.unseen(&chosen)?, search.unseen(&from_position)?)
        {
            let error = alone.error();
            position_alone = Some(Tried { cutoff_hz, error });
            if fused.above(&alone) > CHANCE {
                chosen = from_position;
            }
        }
    }
    let tried = cutoffs
        .iter()
        .zip(error)
        .map(|(&cutoff_hz, error)| Tried { cutoff_hz, error })
        .collect();
    Ok((
        chosen,
        Some(CutoffChoice {
            tried,
            position_alone,
        }),
    ))
}

/// Whether rigid body and friction explain the torque of `data` better out of fold with the preparation `one` than with `other`.
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
    let search = search(robot, &sample);
    let both = (search.unseen(one)?, search.unseen(other)?);
    Ok(matches!(both, (Some(one), Some(other)) if one.error() < other.error()))
}

/// Part of the recordings that is used.
fn sample_of(data: &[Recording]) -> Vec<Recording> {
    let share = SAMPLES / data.len().max(1);
    data.iter().map(|r| part_of(r, share)).collect()
}

/// Time around a block of rows that is left out together with it, s: the reach of the low-pass and of the residual.
pub fn gap(options: &PrepareOptions) -> f64 {
    options.cutoff_hz.map_or(MEMORY, |hz| MEMORY.max(1.0 / hz))
}

/// Search on a sample, which compares the same rows at all cut-offs.
fn search<'a>(robot: &'a Robot, sample: &'a [Recording]) -> Search<'a> {
    Search::new(robot, sample, MEMORY.max(1.0 / RANGE_HZ[0]))
}

/// Errors at several cut-offs, without those at which no fit was possible.
fn errors(
    search: &Search,
    cutoffs: &[f64],
    options: &PrepareOptions,
) -> Result<Vec<(f64, Unseen)>, CutoffError> {
    let tried = cutoffs.par_iter().map(|&cutoff_hz| {
        let unseen = search.unseen(&PrepareOptions {
            cutoff_hz: Some(cutoff_hz),
            ..*options
        })?;
        Ok(unseen.map(|unseen| (cutoff_hz, unseen)))
    });
    let tried: Vec<Option<(f64, Unseen)>> = tried.collect::<Result<_, CutoffError>>()?;
    Ok(tried.into_iter().flatten().collect())
}

/// Index of the least error.
fn least(errors: &[f64]) -> Option<usize> {
    (0..errors.len()).min_by(|&a, &b| errors[a].total_cmp(&errors[b]))
}

/// Geometric mean of the ends of the stretch of cut-offs around the best one for which `alike` holds.
fn middle(cutoffs: &[f64], best: usize, alike: impl Fn(usize) -> bool) -> f64 {
    let alike = |&k: &usize| k == best || alike(k);
    let first = (0..=best).rev().take_while(alike).last();
    let last = (best..cutoffs.len()).take_while(alike).last();
    (cutoffs[first.unwrap_or(best)] * cutoffs[last.unwrap_or(best)]).sqrt()
}

/// Some of a recording's trajectories, evenly spread, with about `samples` samples; of a single longer one its beginning.
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

    #[test]
    fn the_middle_of_what_is_as_good_as_the_best() {
        // Flat from 4 to 16 Hz: 8 Hz. What is as good far away is not joined to the best.
        let cutoffs = [2.0, 4.0, 8.0, 16.0, 32.0, 64.0];
        let flat = [false, true, true, true, false, true];
        assert_eq!(middle(&cutoffs, 2, |k| flat[k]), 8.0);
        assert_eq!(middle(&cutoffs, 3, |_| false), 16.0);
    }
}
