//! Matching of executions of one motion in two recordings, and the shift in time between them.
//!
//! Logs of one program are rarely cut at the same instant, so that the shift is looked for, too.

use ndarray::{Array2, ArrayView2};
use signal::resample;
use std::ops::Range;

/// Step of the coarse search for the shift, s.
const COARSE: f64 = 0.05;
/// Resolution of the shift, s.
const FINE: f64 = 5e-4;
/// Largest shift, relative to the length of the shorter execution.
const SHIFTED: f64 = 0.2;
/// Largest root mean square difference of a joint's positions, over their standard deviation.
const SAME: f64 = 0.05;
/// Largest root mean square difference of a joint that hardly moves, rad or m.
const STILL: f64 = 2e-3;
/// Difference over the standard deviation up to which a coarse match is refined.
const NEARLY: f64 = 0.5;

/// One trajectory: time stamps and positions.
#[derive(Clone, Debug)]
pub struct Execution {
    /// Time of each sample since the trajectory's start, s.
    time: Vec<f64>,
    /// Positions, rad (m), shape (samples, joints).
    q: Array2<f64>,
    /// Positions every [`COARSE`] seconds, shape (steps, joints).
    coarse: Array2<f64>,
    /// Standard deviation of each joint's positions, at least `STILL / SAME`, rad (m).
    scale: Vec<f64>,
    moves: bool,
}

impl Execution {
    /// Execution of the samples `rows` of a recording.
    pub fn new(time: &[f64], q: &Array2<f64>, rows: Range<usize>) -> Self {
        let start = time[rows.start];
        let time: Vec<f64> = time[rows.clone()].iter().map(|t| t - start).collect();
        let q = q.slice_axis(ndarray::Axis(0), rows.into()).to_owned();
        let deviation: Vec<f64> = q.columns().into_iter().map(|c| c.std(0.0)).collect();
        let steps = (time[time.len() - 1] / COARSE) as usize + 1;
        let at: Vec<f64> = (0..steps).map(|k| k as f64 * COARSE).collect();
        Self {
            coarse: at_times(&time, q.view(), &at),
            moves: deviation.iter().any(|d| *d > STILL / SAME),
            scale: deviation.into_iter().map(|d| d.max(STILL / SAME)).collect(),
            time,
            q,
        }
    }

    /// Duration of the execution, s.
    pub fn length(&self) -> f64 {
        self.time.last().copied().unwrap_or(0.0)
    }

    /// Shift to be added to this execution's time to get the other's, s, where both execute one motion.
    /// Standstill counts as no motion.
    pub fn shift_to(&self, other: &Self) -> Option<f64> {
        if !(self.moves && other.moves) {
            return None;
        }
        let shorter = self.coarse.nrows().min(other.coarse.nrows());
        let most = (SHIFTED * shorter as f64) as isize;
        let rough = (-most..=most)
            .filter_map(|k| Some((self.coarse_apart(other, k, shorter)?, k)))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .filter(|(apart, _)| *apart < NEARLY * NEARLY)?;
        let mean = |shift: f64| {
            let apart = self.apart(other, shift);
            apart.iter().map(|a| a * a).sum::<f64>()
        };
        let shift = least(rough.1 as f64 * COARSE, mean);
        let same = self.apart(other, shift).iter().all(|a| *a <= SAME);
        same.then_some(shift)
    }

    /// Mean squared difference over the standard deviation, averaged over joints, at a shift of `k` coarse
    /// steps. None where both have less than the allowed part of `shorter` in common.
    fn coarse_apart(&self, other: &Self, k: isize, shorter: usize) -> Option<f64> {
        let first = (-k).max(0) as usize;
        let end = self
            .coarse
            .nrows()
            .min((other.coarse.nrows() as isize - k).max(0) as usize);
        let common = end.checked_sub(first)?;
        if (common as f64) < (1.0 - SHIFTED) * shorter as f64 || common == 0 {
            return None;
        }
        let mut sum = 0.0;
        for i in first..end {
            let own = self.coarse.row(i);
            let its = other.coarse.row((i as isize + k) as usize);
            let both = own.iter().zip(its).zip(&self.scale);
            sum += both.map(|((a, b), s)| ((a - b) / s).powi(2)).sum::<f64>();
        }
        Some(sum / (common * self.scale.len()) as f64)
    }

    /// Root mean square difference of each joint over its standard deviation.
    fn apart(&self, other: &Self, shift: f64) -> Vec<f64> {
        let rows = self.common(other.length(), shift);
        let at: Vec<f64> = self.time[rows.clone()].iter().map(|t| t + shift).collect();
        let its = at_times(&other.time, other.q.view(), &at);
        let own = self.q.slice_axis(ndarray::Axis(0), rows.into());
        let difference = &own - &its;
        let columns = difference.columns().into_iter().zip(&self.scale);
        columns
            .map(|(c, s)| (c.dot(&c) / c.len().max(1) as f64).sqrt() / s)
            .collect()
    }

    /// Own samples that lie within an execution of duration `length`, s, after the shift.
    fn common(&self, length: f64, shift: f64) -> Range<usize> {
        let first = self.time.partition_point(|t| t + shift < 0.0);
        let end = self.time.partition_point(|t| t + shift <= length);
        first..end.max(first)
    }

    /// Values of `table`, shape (samples of the other execution, joints), interpolated at this execution's time
    /// stamps. Returns the own samples that lie within the other execution, and their rows.
    pub fn replayed(
        &self,
        other: &Self,
        table: ArrayView2<f64>,
        shift: f64,
    ) -> (Range<usize>, Array2<f64>) {
        let rows = self.common(other.length(), shift);
        let at: Vec<f64> = self.time[rows.clone()].iter().map(|t| t + shift).collect();
        (rows, at_times(&other.time, table, &at))
    }
}

/// Rows of a table interpolated at the times `at`, shape (times, columns).
fn at_times(time: &[f64], table: ArrayView2<f64>, at: &[f64]) -> Array2<f64> {
    let mut out = Array2::zeros((at.len(), table.ncols()));
    for (mut to, from) in out.columns_mut().into_iter().zip(table.columns()) {
        let values = resample::linear(time, &from.to_vec(), at);
        to.iter_mut().zip(values).for_each(|(t, v)| *t = v);
    }
    out
}

/// Shift within a coarse step of `about` at which `f` is least, by ternary search.
fn least(about: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (about - COARSE, about + COARSE);
    while high - low > FINE {
        let third = (high - low) / 3.0;
        let (a, b) = (low + third, high - third);
        if f(a) < f(b) {
            high = b;
        } else {
            low = a;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use signal::Motion;

    /// Two joints at `rate` Hz from `start` on; joint 2 is `factor` times as wide.
    fn motion(start: f64, length: f64, rate: f64, factor: f64) -> Motion {
        let n = (length * rate) as usize;
        let time: Vec<f64> = (0..n).map(|k| 100.0 + k as f64 / rate).collect();
        let path = |t: f64| {
            [
                (0.9 * t).sin() + 0.4 * (2.3 * t).cos(),
                factor * (1.3 * t).sin(),
            ]
        };
        let at = |k: usize| path(start + k as f64 / rate);
        let q = Array2::from_shape_fn((n, 2), |(k, j)| at(k)[j]);
        let zero = Array2::zeros((n, 2));
        Motion {
            time,
            segments: std::iter::once(0..n).collect(),
            q,
            qd: zero.clone(),
            qdd: zero,
        }
    }

    fn execution(motion: &Motion) -> Execution {
        Execution::new(&motion.time, &motion.q, 0..motion.len())
    }

    #[test]
    fn the_shift_of_two_logs_of_one_program_is_found() {
        let (a, b) = (
            motion(0.0, 20.0, 100.0, 1.0),
            motion(1.337, 20.0, 250.0, 1.0),
        );
        let (a, b) = (execution(&a), execution(&b));
        let shift = b.shift_to(&a).unwrap();
        assert!((shift - 1.337).abs() < 1e-3, "{shift}");
        // What was recorded beside the one is read at the other's stamps.
        let table = Array2::from_shape_fn((a.time.len(), 1), |(k, _)| a.time[k]);
        let (rows, values) = b.replayed(&a, table.view(), shift);
        assert_eq!(rows.start, 0);
        assert!((b.time[rows.end - 1] - (a.length() - 1.337)).abs() < 0.01);
        let worst = rows
            .clone()
            .map(|i| (values[[i - rows.start, 0]] - b.time[i] - 1.337).abs());
        assert!(worst.fold(0.0, f64::max) < 1e-3);
    }

    #[test]
    fn another_motion_and_standstill_are_no_repeat() {
        let a = execution(&motion(0.0, 20.0, 100.0, 1.0));
        assert!(
            execution(&motion(0.0, 20.0, 100.0, 1.15))
                .shift_to(&a)
                .is_none()
        );
        assert!(
            execution(&motion(9.0, 20.0, 100.0, 1.0))
                .shift_to(&a)
                .is_none()
        );
        let mut still = motion(0.0, 20.0, 100.0, 1.0);
        still.q.fill(0.3);
        let still = execution(&still);
        assert!(still.shift_to(&still).is_none());
    }
}
