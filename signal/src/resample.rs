//! Uniform grids, interpolation at jittered stamps and shifts by fractions of a sample.

use crate::spline::{CubicEnd, Spline, SplineError};

/// Uniform grid from `start` to at most `end`; the last point may lie up to one step before it.
///
/// A rounding error of a millionth of a step does not lose the last point. A step that is not
/// positive, or an end before the start, gives no points.
pub fn uniform_grid(start: f64, end: f64, step: f64) -> Vec<f64> {
    if !(step > 0.0 && end >= start && (end - start).is_finite()) {
        return Vec::new();
    }
    let last = ((end - start) / step + 1e-6).floor() as usize;
    (0..=last).map(|k| start + k as f64 * step).collect()
}

/// Number of steps forward that are tried before a search.
const NEAR: usize = 8;

/// Positions of time stamps between the samples of one time axis, for many signals on the same two axes.
#[derive(Clone, Debug)]
pub struct Between {
    /// Place of each stamp: index of the sample at or before it, index of the next sample, and the stamp's fraction of
    /// the way between them, 0 to 1.
    places: Vec<(usize, usize, f64)>,
}

impl Between {
    /// Finds the places of `at` among the times of the samples, which increase.
    ///
    /// # Panics
    /// If there are no samples.
    pub fn new(time: &[f64], at: impl IntoIterator<Item = f64>) -> Self {
        let last = time.len() - 1;
        let mut right = 0;
        let place = |t: f64| {
            // Stamps mostly go on from one to the next: a step or two, not a search.
            let near = (right..=last + 1)
                .take(NEAR)
                .find(|&k| (k > last || time[k] > t) && (k == 0 || time[k - 1] <= t));
            right = near.unwrap_or_else(|| time.partition_point(|&s| s <= t));
            if right == 0 || right > last {
                let end = right.min(last);
                (end, end, 0.0)
            } else {
                let share = (t - time[right - 1]) / (time[right] - time[right - 1]);
                (right - 1, right, share)
            }
        };
        Self {
            places: at.into_iter().map(place).collect(),
        }
    }

    /// Values of a signal at these stamps: linear between the samples, constant outside them.
    ///
    /// # Panics
    /// If the signal has fewer values than there were samples.
    pub fn of<'a>(&'a self, values: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let places = self.places.iter();
        places.map(|&(left, right, share)| values[left] + share * (values[right] - values[left]))
    }
}

/// Values at `at`, linear between the samples, constant outside them.
///
/// # Panics
/// If there are no samples.
pub fn linear(time: &[f64], values: &[f64], at: &[f64]) -> Vec<f64> {
    Between::new(time, at.iter().copied()).of(values).collect()
}

/// Values at `at` by a cubic spline through the samples, constant outside them.
///
/// # Errors
/// Fewer than four samples, or times that do not increase.
pub fn cubic(time: &[f64], values: &[f64], at: &[f64]) -> Result<Vec<f64>, SplineError> {
    let spline = Spline::cubic(time, values, CubicEnd::NotAKnot)?;
    let (first, last) = (time[0], time[time.len() - 1]);
    Ok(at
        .iter()
        .map(|&t| spline.at(t.clamp(first, last))[0])
        .collect())
}

/// Signal delayed by `delay` seconds: y(t) = x(t − delay) at the same stamps, by a cubic spline; the ends are held.
///
/// # Errors
/// Fewer than four samples, or times that do not increase.
pub fn delayed(time: &[f64], values: &[f64], delay: f64) -> Result<Vec<f64>, SplineError> {
    let at: Vec<f64> = time.iter().map(|t| t - delay).collect();
    cubic(time, values, &at)
}
