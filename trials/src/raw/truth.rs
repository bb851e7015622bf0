//! Truth about a raw recording.

use super::channel::Channel;
use crate::lag::Lag;
use plant::run::Trace;
use serde::Serialize;
use std::ops::Range;

/// Smallest and largest shift of the torque that is tried, s.
const SHIFTS: [f64; 2] = [-0.05, 0.25];

/// Values that an estimator should find in the training part. Joints base first.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RawTruth {
    /// Conditions of the recording.
    #[serde(flatten)]
    pub setting: Setting,
    /// Filter of each joint's torque.
    pub lag: Vec<Lag>,
    /// Shift beside the filter, s.
    pub shift: f64,
    /// Delay of all joints: the shift that best maps the torque before the channel onto the torque behind filter and
    /// shift, squared errors in units of each joint's variance, s.
    pub delay: f64,
    /// Delay of each joint's torque, s.
    pub joint_delay: Vec<f64>,
    /// Gain of each joint's channel: logged over real torque.
    pub gain: Vec<f64>,
    /// Offset that is added to the torque of each joint, N·m.
    pub offset: Vec<f64>,
}

/// Conditions of a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Setting {
    /// Name of the recording's files.
    pub id: String,
    /// Seed of the run of `simulate`.
    pub seed: u64,
    /// Index of the recording in the run.
    pub index: u64,
    /// Family from which the robot was drawn.
    pub robot: String,
    /// Sampling rate of the log, Hz.
    pub rate_hz: f64,
    /// Standard deviation of the time step over its mean.
    pub jitter: f64,
    /// Part of the samples that is lost.
    pub lost: f64,
    /// Delay of the logged velocity after the position, s; none where it is not logged.
    pub velocity_late: Option<f64>,
    /// Largest relative error of the description's masses and inertias.
    pub inertial_error: f64,
}

/// The truth of the channel on some rows of the trace.
pub(super) fn of(
    trace: &Trace,
    channel: &Channel,
    filtered: &[f64],
    rows: &[Range<usize>],
    setting: Setting,
) -> RawTruth {
    let n = trace.dof;
    let tick = 1.0 / super::clock::TRACE_HZ;
    let column = |table: &[f64], j: usize| -> Vec<f64> {
        table.iter().skip(j).step_by(n).copied().collect()
    };
    let errors: Vec<Vec<f64>> = (0..n)
        .map(|j| shift_errors(&column(&trace.tau, j), &column(filtered, j), rows, tick))
        .collect();
    let mut all = vec![0.0; errors[0].len()];
    for own in &errors {
        all.iter_mut().zip(own).for_each(|(a, e)| *a += e);
    }
    RawTruth {
        setting,
        lag: channel.lag.clone(),
        shift: channel.shift,
        delay: least(&all, tick),
        joint_delay: errors.iter().map(|e| least(e, tick)).collect(),
        gain: channel.gain.clone(),
        offset: channel.offset.clone(),
    }
}

/// The shift (s) that best maps `before` onto `behind`: argmin over d of Σ (behind(t) − before(t − d))² over `rows`; both
/// with the step `tick`, s.
pub fn best_shift(before: &[f64], behind: &[f64], rows: &[Range<usize>], tick: f64) -> f64 {
    least(&shift_errors(before, behind, rows, tick), tick)
}

/// Mean squared error of each shift by whole ticks, over the variance of `before`.
fn shift_errors(before: &[f64], behind: &[f64], rows: &[Range<usize>], tick: f64) -> Vec<f64> {
    let reach = SHIFTS.map(|s| (s / tick).round() as isize);
    let mut errors = vec![0.0; (reach[1] - reach[0]) as usize + 1];
    let (mut sum, mut square, mut count) = (0.0, 0.0, 0.0);
    for r in rows {
        let inside = r.start as isize + reach[1]..r.end as isize + reach[0];
        for t in inside {
            let y = behind[t as usize];
            for (e, d) in errors.iter_mut().zip(reach[0]..) {
                *e += (y - before[(t - d) as usize]).powi(2);
            }
            sum += before[t as usize];
            square += before[t as usize].powi(2);
            count += 1.0;
        }
    }
    let variance = square - sum * sum / f64::max(count, 1.0);
    errors
        .iter()
        .map(|e| e / variance.max(f64::MIN_POSITIVE))
        .collect()
}

/// The shift of least error, between ticks by a parabola.
fn least(errors: &[f64], tick: f64) -> f64 {
    let best = (0..errors.len())
        .min_by(|&a, &b| errors[a].total_cmp(&errors[b]))
        .unwrap_or(0);
    let mut at = best as f64;
    if best > 0 && best + 1 < errors.len() {
        let (a, b, c) = (errors[best - 1], errors[best], errors[best + 1]);
        let bend = a - 2.0 * b + c;
        if bend > 0.0 {
            at += 0.5 * (a - c) / bend;
        }
    }
    SHIFTS[0] + at * tick
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_late_by_its_filters_half_time() {
        // A step behind a first-order filter is best matched where it has come half way: ln 2 time constants.
        let before: Vec<f64> = (0..4000).map(|k| f64::from(k / 1000 % 2)).collect();
        let behind = Lag::First { corner_hz: 5.0 }.apply(&before, 1e-3);
        let found = best_shift(&before, &behind, std::slice::from_ref(&(0..4000)), 1e-3);
        let expected = 2.0_f64.ln() / (std::f64::consts::TAU * 5.0);
        assert!((found - expected).abs() < 1.5e-3, "{found} {expected}");
    }
}
