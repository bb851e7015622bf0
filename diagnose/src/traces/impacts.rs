//! Blows of a transmission with play: bursts of vibration right after the transmitted torque has changed its sign.
//!
//! A gap is crossed when the link no longer presses on its flank, and each crossing ends with a blow on the other
//! flank that rings for some hundredths of a second, above the band in which torques of motion live. When a blow
//! comes depends on the play, how it rings on much that a model does not know; that it follows the change of sign
//! does not. So the vibration after such changes is compared with that before them and elsewhere. Reversals of the
//! motion, where friction jumps, are left out. Confounders: ripple of a fast joint, which vibrates before the change
//! as it does after it; delay, whose error is smooth.

use crate::motion::frame::Frame;
use crate::settings::BlowSettings;
use ndarray::{Array1, Array2};
use signal::filter::filtfilt;
use signal::sos::{Section, butterworth};
use std::ops::Range;

/// Band of the vibration, Hz.
const BAND: (f64, f64) = (12.0, 40.0);
/// Time around a change of sign in which a blow falls, s, before and after.
const AFTER: (f64, f64) = (0.016, 0.12);
/// Time before it that must be quiet, s.
const BEFORE: f64 = 0.15;
/// Time around the joint's own reversal that is left out, s, before and after.
const OWN: (f64, f64) = (0.04, 0.08);
/// The same around another joint's.
const OTHER: (f64, f64) = (0.024, 0.048);
/// Ends of trajectories that are left out, s.
const EDGE: f64 = 0.1;

/// Vibration of one joint after its torque changed sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impacts {
    /// The joint.
    pub joint: usize,
    /// Its power over the greater of that before the changes and that elsewhere.
    pub ratio: f64,
    /// Root mean square while blows last, over the deviation of the joint's torque.
    pub size: f64,
}

/// The joint whose blows are clearest, if any joint's are. `residual` and `load`, the torque that its link needs, at
/// the recorded samples; shape (samples, joints).
pub fn clearest(
    frame: &Frame,
    residual: &Array2<f64>,
    load: &Array2<f64>,
    settings: &BlowSettings,
) -> Option<Impacts> {
    let fewest = settings.fewest;
    let rate = frame.report().rate_hz;
    let high = BAND.1.min(0.35 * rate);
    if high < 2.0 * BAND.0 {
        return None;
    }
    let (low, high) = (
        butterworth(2, BAND.0, rate).ok()?,
        butterworth(2, high, rate).ok()?,
    );
    let samples = frame.samples();
    let segments = &samples.segments;
    let turns: Vec<Vec<usize>> = (0..frame.dof())
        .map(|j| changes(samples.qd.column(j).iter().copied(), segments))
        .collect();
    let found = (0..frame.dof()).filter_map(|j| {
        let own = changes(load.column(j).iter().copied(), segments);
        let vibration = band(&residual.column(j).to_vec(), segments, &low, &high);
        let torque = frame.tau.column(j).std(0.0).max(1e-12);
        let usable = |others: bool| {
            let mut usable = vec![true; samples.len()];
            for s in segments {
                let edge = ((EDGE * rate) as usize).min(s.len());
                usable[s.start..s.start + edge].fill(false);
                usable[s.end - edge..s.end].fill(false);
            }
            for (k, at) in turns.iter().enumerate().filter(|(k, _)| others || *k == j) {
                let reach = if k == j { OWN } else { OTHER };
                mark(&mut usable, at, reach, rate, false);
            }
            usable
        };
        // Where other joints turn round all the time, their reversals must be borne with.
        let (ratio, size) = contrast(&vibration, &usable(true), &own, rate, fewest)
            .or_else(|| contrast(&vibration, &usable(false), &own, rate, fewest))?;
        Some(Impacts {
            joint: j,
            ratio,
            size: size / torque,
        })
    });
    found
        .filter(|i| i.ratio > settings.ratio && i.size > settings.least)
        .max_by(|a, b| a.ratio.total_cmp(&b.ratio))
}

/// Ratio of the power after the changes to that before them or elsewhere, and the root of the former's excess; none where
/// fewer than `fewest` changes are seen.
fn contrast(
    vibration: &Array1<f64>,
    usable: &[bool],
    at: &[usize],
    rate: f64,
    fewest: usize,
) -> Option<(f64, f64)> {
    let n = usable.len();
    let (mut after, mut before) = (vec![false; n], vec![false; n]);
    mark(&mut after, at, AFTER, rate, true);
    mark(&mut before, at, (BEFORE, 0.0), rate, true);
    let reach = (AFTER.1 * rate) as usize;
    let seen = at
        .iter()
        .filter(|&&i| usable[i..(i + reach).min(n)].iter().filter(|u| **u).count() > reach / 3);
    if seen.count() < fewest {
        return None;
    }
    let power = |of: &dyn Fn(usize) -> bool| {
        let (sum, count) = (0..n)
            .filter(|&i| usable[i] && of(i))
            .fold((0.0, 0usize), |(s, c), i| {
                (s + vibration[i] * vibration[i], c + 1)
            });
        (count > 20).then(|| sum / count as f64)
    };
    let hit = power(&|i| after[i])?;
    let quiet = power(&|i| before[i] && !after[i]);
    let elsewhere = power(&|i| !before[i] && !after[i]);
    let usual = quiet.into_iter().chain(elsewhere).reduce(f64::max)?;
    Some((hit / usual.max(1e-300), (hit - usual).max(0.0).sqrt()))
}

/// Samples before which a signal changes its sign, within segments.
pub(super) fn changes(x: impl Iterator<Item = f64>, segments: &[Range<usize>]) -> Vec<usize> {
    let x: Vec<f64> = x.collect();
    segments
        .iter()
        .flat_map(|s| s.start + 1..s.end)
        .filter(|&i| x[i] * x[i - 1] <= 0.0 && x[i] != x[i - 1])
        .collect()
}

fn mark(flags: &mut [bool], at: &[usize], reach: (f64, f64), rate: f64, value: bool) {
    let (before, after) = ((reach.0 * rate) as usize, (reach.1 * rate) as usize);
    let n = flags.len();
    for &i in at {
        flags[i.saturating_sub(before)..(i + after + 1).min(n)].fill(value);
    }
}

/// What lies between two low-passes.
fn band(x: &[f64], segments: &[Range<usize>], low: &[Section], high: &[Section]) -> Array1<f64> {
    let mut out = Array1::zeros(x.len());
    for s in segments {
        let smooth = filtfilt(high, &x[s.clone()]);
        let slow = filtfilt(low, &smooth);
        for (i, (a, b)) in s.clone().zip(smooth.iter().zip(slow)) {
            out[i] = a - b;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vibration that starts at each change of sign, or that is always there.
    fn seen(ringing: impl Fn(usize) -> f64) -> f64 {
        let rate = 250.0;
        let load: Vec<f64> = (0..5000).map(|i| (f64::from(i) * 0.0157).sin()).collect();
        let at = changes(load.into_iter(), std::slice::from_ref(&(0..5000)));
        assert!(at.len() > 20);
        let vibration: Array1<f64> = (0..5000)
            .map(|i| {
                let since = at.iter().filter(|&&a| a <= i).map(|&a| i - a).min();
                let phase = i as f64 * 0.7;
                (0.1 + ringing(since.unwrap_or(1000))) * phase.sin()
            })
            .collect();
        contrast(&vibration, &vec![true; 5000], &at, rate, 6)
            .unwrap()
            .0
    }

    #[test]
    fn ringing_after_changes_is_told_from_vibration_throughout() {
        assert!(seen(|since| (-(since as f64) / 8.0).exp()) > BlowSettings::default().ratio);
        assert!(seen(|_| 0.5) < 1.5);
    }
}
