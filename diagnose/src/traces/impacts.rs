//! Impacts (blows) in a transmission with backlash: bursts of vibration right after a sign change of the transmitted
//! torque.
//!
//! The gap is crossed when the link no longer presses on its tooth flank. Each crossing ends with an impact on the
//! other flank. It rings for some hundredths of a second, above the band of most torques of motion. Its exact time and
//! form depend on much that a model does not know, but it always follows the sign change.
//!
//! The vibration after sign changes is therefore compared with that before them and elsewhere. Reversals of the motion,
//! where friction jumps, are left out. The chance level comes from sign changes shifted circularly in time.
//! Confounders: ripple of a fast joint, which vibrates before the change as much as after it; delay, whose error is
//! smooth.

use crate::motion::frame::Frame;
use crate::settings::BlowSettings;
use ndarray::{Array1, Array2};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use signal::filter::filtfilt;
use signal::sos::{Section, butterworth};
use std::ops::Range;

/// Band of the vibration in which impacts are searched, Hz.
const BAND: (f64, f64) = (12.0, 40.0);
/// Lowest upper end of the vibration's band, Hz, with which impacts can be searched.
const LOWEST: f64 = 15.0;
/// Window around a sign change in which an impact is searched, s before and after.
const AFTER: (f64, f64) = (0.016, 0.12);
/// Window before a sign change whose vibration is the reference, s.
const BEFORE: f64 = 0.15;
/// Window around the joint's own reversal that is left out, s before and after.
const OWN: (f64, f64) = (0.04, 0.08);
/// Window around another joint's reversal that is left out, s before and after.
const OTHER: (f64, f64) = (0.024, 0.048);
/// Time left out at each end of a trajectory, s.
const EDGE: f64 = 0.1;
/// Number of circular shifts of the sign changes by which the chance level is computed.
const MOVED: u64 = 199;
/// Seed of the random shifts.
const SEED: u64 = 0xB10;

/// Vibration of one joint after sign changes of its torque, compared with its vibration otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impacts {
    /// Index of the joint whose torque changes its sign.
    pub joint: usize,
    /// Ratio of the vibration's power after sign changes to that before them or elsewhere, whichever is greater.
    pub ratio: f64,
    /// RMS of the vibration in excess after sign changes, relative to the standard deviation of the joint's torque.
    pub size: f64,
    /// Number of sign changes after which enough samples can be used.
    pub changes: usize,
    /// Part of these sign changes after which the vibration is stronger than its typical level.
    pub followed: f64,
}

impl Impacts {
    /// Evidence for impacts, nats: log-likelihood ratio of the vibration's variance with and without them.
    fn weight(&self) -> f64 {
        0.5 * self.changes as f64 * self.ratio.ln()
    }
}

/// Signals of one joint in which impacts are searched.
struct Listened {
    /// Index of the joint.
    joint: usize,
    /// Band-passed residual at the recorded samples.
    vibration: Array1<f64>,
    /// Standard deviation of the joint's torque.
    torque: f64,
    /// First sample after each sign change of the torque.
    changes: Vec<usize>,
    /// Whether each sample lies away from reversals and ends.
    usable: Vec<bool>,
}

impl Listened {
    /// Vibration after the sign changes `changes`; none where fewer than `fewest` can be used.
    fn after(&self, changes: &[usize], rate: f64, fewest: usize) -> Option<Impacts> {
        let seen = contrast(&self.vibration, &self.usable, changes, rate, fewest)?;
        Some(Impacts {
            joint: self.joint,
            ratio: seen.ratio,
            size: seen.excess / self.torque,
            changes: seen.changes,
            followed: seen.followed,
        })
    }
}

/// Search for impacts on all joints of a recording.
pub struct Blows<'a> {
    /// Signals of each joint.
    joints: Vec<Listened>,
    /// Ranges of samples of each trajectory.
    segments: &'a [Range<usize>],
    /// Sampling rate, Hz.
    rate: f64,
    /// Thresholds of the search.
    settings: &'a BlowSettings,
}

impl<'a> Blows<'a> {
    /// Prepares the search in a fit's residual. `residual`, and the torque `load` that each joint's link needs, have
    /// the shape (samples, joints). None where the sampling rate is too low for the vibration.
    pub fn new(
        frame: &'a Frame,
        residual: &Array2<f64>,
        load: &Array2<f64>,
        settings: &'a BlowSettings,
    ) -> Option<Self> {
        let rate = frame.report().rate_hz;
        let (foot, top) = heard(rate)?;
        // Windows are widened with a lower band, as its filters spread steps of friction over a longer time.
        let wider = BAND.0 / foot;
        let (low, high) = (
            butterworth(2, foot, rate).ok()?,
            butterworth(2, top, rate).ok()?,
        );
        let samples = frame.samples();
        let segments = &samples.segments;
        let turns: Vec<Vec<usize>> = (0..frame.dof())
            .map(|j| changes(samples.qd.column(j).iter().copied(), segments))
            .collect();
        let listened = |joint: usize| {
            let changes = changes(load.column(joint).iter().copied(), segments);
            let usable = |others: bool| {
                let mut usable = vec![true; samples.len()];
                for s in segments {
                    let edge = count(EDGE * wider, rate).min(s.len());
                    usable[s.start..s.start + edge].fill(false);
                    usable[s.end - edge..s.end].fill(false);
                }
                for (k, at) in turns
                    .iter()
                    .enumerate()
                    .filter(|(k, _)| others || *k == joint)
                {
                    let (before, after) = if k == joint { OWN } else { OTHER };
                    mark(
                        &mut usable,
                        at,
                        (wider * before, wider * after),
                        rate,
                        false,
                    );
                }
                usable
            };
            let mut one = Listened {
                joint,
                vibration: band(&residual.column(joint).to_vec(), segments, &low, &high),
                torque: frame.tau.column(joint).std(0.0).max(1e-12),
                usable: usable(true),
                changes,
            };
            // Reversals of other joints are only left out where enough samples remain without them.
            if one.after(&one.changes, rate, settings.fewest).is_none() {
                one.usable = usable(false);
            }
            one
        };
        Some(Self {
            joints: (0..frame.dof()).map(listened).collect(),
            segments,
            rate,
            settings,
        })
    }

    /// Joint with the strongest evidence of impacts; none where no joint passes the thresholds.
    pub fn clearest(&self) -> Option<Impacts> {
        self.following(|joint| joint.after(&joint.changes, self.rate, self.settings.fewest))
    }

    /// Joint with the strongest evidence among those that pass the thresholds. `after` gives the vibration of a joint
    /// after its sign changes.
    fn following(&self, after: impl Fn(&Listened) -> Option<Impacts>) -> Option<Impacts> {
        let each = self.joints.iter().filter_map(after);
        let s = self.settings;
        each.filter(|i| i.ratio > s.ratio && i.size > s.least && i.followed > s.followed)
            .max_by(|a, b| a.weight().total_cmp(&b.weight()))
    }

    /// Probability (p-value) of impacts as clear as `seen` by chance: (1 + number of clearer shifts)/(1 + [`MOVED`]).
    /// In each shift, the sign changes of every trajectory move circularly by a random time.
    pub fn chance(&self, seen: &Impacts) -> f64 {
        let as_clear = |number: u64| {
            let mut rng = ChaCha8Rng::seed_from_u64(SEED);
            rng.set_stream(number);
            let by: Vec<usize> = (self.segments.iter())
                .map(|s| rng.random_range(0..s.len().max(1)))
                .collect();
            let clearest = self.following(|joint| {
                let moved = moved(&joint.changes, self.segments, &by);
                joint.after(&moved, self.rate, self.settings.fewest)
            });
            clearest.is_some_and(|i| i.weight() >= seen.weight())
        };
        let reached = (0..MOVED).into_par_iter().filter(|n| as_clear(*n)).count();
        (1 + reached) as f64 / (1 + MOVED) as f64
    }
}

/// Band of vibration, Hz, that can be evaluated at a sampling rate; none where it is too low. A slow recording gets a
/// lower band, which holds the first part of the ringing, too.
fn heard(rate: f64) -> Option<(f64, f64)> {
    let top = BAND.1.min(0.35 * rate);
    (top >= LOWEST).then(|| (BAND.0.min(0.4 * top), top))
}

/// Sample indices `at` shifted circularly within their segments, by the number of samples `by` of each segment.
fn moved(at: &[usize], segments: &[Range<usize>], by: &[usize]) -> Vec<usize> {
    let each = segments.iter().zip(by).flat_map(|(s, by)| {
        let own = at.iter().filter(|i| s.contains(i));
        own.map(move |i| s.start + (i - s.start + by) % s.len())
    });
    each.collect()
}

/// Vibration after sign changes compared with that before them or elsewhere, whichever is greater.
struct Contrast {
    /// Ratio of the vibration's power after sign changes to the reference.
    ratio: f64,
    /// RMS of the vibration in excess of the reference, N·m (N).
    excess: f64,
    /// Number of sign changes after which enough samples can be used.
    changes: usize,
    /// Part of these sign changes after which the vibration is stronger than the reference. Impacts make it large; one
    /// passage of strong vibration does not.
    followed: f64,
}

/// Contrast of the vibration after the sign changes `at`; none where fewer than `fewest` can be used. `usable` tells
/// the samples away from reversals and ends.
fn contrast(
    vibration: &Array1<f64>,
    usable: &[bool],
    at: &[usize],
    rate: f64,
    fewest: usize,
) -> Option<Contrast> {
    let n = usable.len();
    let (mut after, mut before) = (vec![false; n], vec![false; n]);
    mark(&mut after, at, AFTER, rate, true);
    mark(&mut before, at, (BEFORE, 0.0), rate, true);
    let reach = count(AFTER.1, rate);
    let seen: Vec<usize> = at
        .iter()
        .copied()
        .filter(|&i| usable[i..(i + reach).min(n)].iter().filter(|u| **u).count() > reach / 3)
        .collect();
    if seen.len() < fewest {
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
    let excess = (hit - usual).max(0.0).sqrt();
    let louder = |i: &&usize| {
        let rows = (**i..(**i + reach).min(n)).filter(|r| usable[*r]);
        let (sum, count) = rows.fold((0.0, 0usize), |(s, c), r| {
            (s + vibration[r] * vibration[r], c + 1)
        });
        sum > usual * count as f64
    };
    let followed = seen.iter().filter(louder).count() as f64 / seen.len() as f64;
    Some(Contrast {
        ratio: hit / usual.max(1e-300),
        excess,
        changes: seen.len(),
        followed,
    })
}

/// First sample after each sign change of a signal, within segments.
pub(super) fn changes(x: impl Iterator<Item = f64>, segments: &[Range<usize>]) -> Vec<usize> {
    let x: Vec<f64> = x.collect();
    segments
        .iter()
        .flat_map(|s| s.start + 1..s.end)
        .filter(|&i| x[i] * x[i - 1] <= 0.0 && x[i] != x[i - 1])
        .collect()
}

/// Number of samples in a time, s, at a rate in Hz. A rate that the time stamps give slightly too low does not lose a
/// sample.
fn count(time: f64, rate: f64) -> usize {
    (time * rate + 0.01) as usize
}

/// Sets `flags` to `value` in a window around each sample of `at`; `reach` is in s before and after.
fn mark(flags: &mut [bool], at: &[usize], reach: (f64, f64), rate: f64, value: bool) {
    let (before, after) = (count(reach.0, rate), count(reach.1, rate));
    let n = flags.len();
    for &i in at {
        flags[i.saturating_sub(before)..(i + after + 1).min(n)].fill(value);
    }
}

/// Band-pass of a signal within each segment: difference of two zero-phase low-passes.
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
            .ratio
    }

    #[test]
    fn slow_recordings_are_heard_lower_down() {
        let about = |(a, b): (f64, f64), (c, d): (f64, f64)| (a - c).abs() + (b - d).abs() < 1e-9;
        assert!(about(heard(250.0).unwrap(), (12.0, 40.0)));
        assert!(about(heard(100.0).unwrap(), (12.0, 35.0)));
        assert!(about(heard(50.0).unwrap(), (7.0, 17.5)));
        assert_eq!(heard(42.0), None);
        assert_eq!([count(0.04, 49.9999), count(0.04, 250.0)], [2, 10]);
    }

    #[test]
    fn ringing_after_changes_is_told_from_vibration_throughout() {
        assert!(seen(|since| (-(since as f64) / 8.0).exp()) > BlowSettings::default().ratio);
        assert!(seen(|_| 0.5) < 1.5);
    }

    /// Blows after every change of a load are no chance; one loud passage that holds as much power is, or is followed too rarely.
    #[test]
    fn what_follows_every_change_is_no_chance() {
        let (n, rate) = (6000, 250.0);
        let segments = [0..3000, 3000..6000];
        // Changes at uneven times, for even ones fall on themselves when they are moved.
        let load = |i: usize| (i as f64 * 0.0157 + 2.0 * (i as f64 * 0.0041).sin()).sin();
        let at = changes((0..n).map(load), &segments);
        let settings = BlowSettings::default();
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let noise: Vec<f64> = (0..n).map(|_| rng.random_range(-0.1..0.1)).collect();
        let of = |loud: &dyn Fn(usize) -> f64| {
            let vibration = (0..n).map(|i| noise[i] + loud(i) * (i as f64 * 0.7).sin());
            let joint = Listened {
                joint: 0,
                vibration: vibration.collect(),
                torque: 1.0,
                changes: at.clone(),
                usable: vec![true; n],
            };
            let blows = Blows {
                joints: vec![joint],
                segments: &segments,
                rate,
                settings: &settings,
            };
            blows.clearest().map(|clearest| blows.chance(&clearest))
        };
        let since = |i: usize| at.iter().filter(|a| **a <= i).map(|a| i - a).min();
        let ringing = |i: usize| since(i).map_or(0.0, |s| (-(s as f64) / 8.0).exp());
        assert!(of(&ringing).unwrap() <= settings.chance);
        let first = at[3];
        let passage = |i: usize| f64::from(u8::from((first..first + 25).contains(&i)));
        assert!(of(&passage).is_none_or(|chance| chance > settings.chance));
    }
}
