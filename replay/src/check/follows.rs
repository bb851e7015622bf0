//! Correlation of a joint's positions with its commands at various delays.

use datasets::Recording;
use ndarray::Array2;
use std::ops::Range;

/// Longest delay from command to position that a drive is believed to have beyond what is given of it, s.
pub(super) const SLOWEST: f64 = 0.5;

/// Largest delay that is tried in either direction, s.
const FARTHEST: f64 = 2.0;
/// Shortest step between the delays that are tried, s. Clocks need not be compared more exactly than a drive's delay is
/// known.
pub(super) const FINEST: f64 = 0.01;

/// Correlation below which positions do not go with commands.
pub(super) const RELATED: f64 = 0.5;
/// Correlation above which positions follow commands.
pub(super) const FOLLOWED: f64 = 0.8;

/// Correlation of positions with earlier commands, over the delays that are tried.
#[derive(Debug, Clone, Copy)]
pub(super) struct Follows {
    /// Delay of the positions after the commands (s) at the largest correlation, and that correlation.
    pub(super) best: (f64, f64),
    /// Largest and smallest correlation at the delays that the drive may have, from 0 on.
    pub(super) drive: [f64; 2],
}

impl Follows {
    /// Correlation over the longest trajectory, for a pair of joints: the commanded one and the one whose position is
    /// taken. `slowest` is the longest delay that its drive may have, s.
    pub(super) fn of(
        recording: &Recording,
        command: &Array2<f64>,
        pair: [usize; 2],
        slowest: f64,
    ) -> Self {
        let longest = recording.trajectories.iter().max_by_key(|t| t.range.len());
        let range = longest.map_or(0..0, |t| t.range.clone());
        Self::over(recording, command, pair, &range, slowest)
    }

    /// Correlation of the positions of joint `moved` with the commands of joint `commanded`, over some rows.
    pub(super) fn over(
        recording: &Recording,
        command: &Array2<f64>,
        [commanded, moved]: [usize; 2],
        rows: &Range<usize>,
        slowest: f64,
    ) -> Self {
        let step = recording.median_step();
        let every = (FINEST / step).round().max(1.0) as usize;
        let step = step * every as f64;
        let thin = |table: &Array2<f64>, j: usize| -> Vec<f64> {
            let rows = rows.clone().step_by(every);
            rows.map(|r| table[(r, j)]).collect()
        };
        let (c, q) = (thin(command, commanded), thin(&recording.q, moved));
        let most = ((FARTHEST / step) as isize).min(c.len() as isize / 4);
        let all: Vec<f64> = (-most..=most).map(|lag| correlation(&c, &q, lag)).collect();
        let lag = |i: usize| (i as isize - most) as f64 * step;
        let best = (0..all.len())
            .max_by(|&a, &b| all[a].total_cmp(&all[b]))
            .unwrap_or(0);
        let by_drive = |i: &usize| (0.0..=slowest).contains(&lag(*i));
        let by_drive: Vec<f64> = (0..all.len()).filter(by_drive).map(|i| all[i]).collect();
        Self {
            best: (
                lag(best) + step * peak(&all, best),
                all.get(best).copied().unwrap_or(0.0),
            ),
            drive: [
                by_drive.iter().copied().fold(-1.0, f64::max),
                by_drive.iter().copied().fold(1.0, f64::min),
            ],
        }
    }
}

/// Offset of the maximum from index `at`, in steps, −0.5 to 0.5: that of the parabola through the value and its
/// neighbours.
fn peak(values: &[f64], at: usize) -> f64 {
    let (Some(before), Some(after)) = (at.checked_sub(1).map(|i| values[i]), values.get(at + 1))
    else {
        return 0.0;
    };
    let bend = before - 2.0 * values[at] + after;
    if bend < 0.0 {
        (0.5 * (before - after) / bend).clamp(-0.5, 0.5)
    } else {
        0.0
    }
}

/// Correlation of `a` with the values of `b` that are `lag` samples later; 0 where one of them is constant.
fn correlation(a: &[f64], b: &[f64], lag: isize) -> f64 {
    let pairs = || {
        let later = |(i, x): (usize, &f64)| {
            let y = b.get(i.checked_add_signed(lag)?)?;
            Some((*x, *y))
        };
        a.iter().enumerate().filter_map(later)
    };
    let (mut count, mut mx, mut my) = (0.0_f64, 0.0, 0.0);
    for (x, y) in pairs() {
        (count, mx, my) = (count + 1.0, mx + x, my + y);
    }
    (mx, my) = (mx / count.max(1.0), my / count.max(1.0));
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in pairs() {
        xy += (x - mx) * (y - my);
        xx += (x - mx).powi(2);
        yy += (y - my).powi(2);
    }
    if xx > 0.0 && yy > 0.0 {
        xy / (xx * yy).sqrt()
    } else {
        0.0
    }
}
