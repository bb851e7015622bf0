//! The commanded motion against the recorded one.

use super::finding::{Finding, Kind, Severity};
use crate::Recording;
use crate::check::moves;
use std::f64::consts::PI;

/// Largest delay that is tried, s, and the step between delays.
const FARTHEST: f64 = 2.0;
const STEP: f64 = 0.01;
/// Largest number of samples of each joint that are looked at.
const MOST: usize = 4000;
/// Least part of a position's variance that a command must explain to be that joint's command.
const EXPLAINED: f64 = 0.9;
/// Time by which a position may come before its command, s: stamps of two threads may be off by so much.
const EARLY: f64 = 0.03;
/// Longest time by which a useful controller follows its command, s.
const LATE: f64 = 0.5;
/// Factor on a command's gain from which its unit is another one. Units of angles are farther apart than this, and no
/// controller misses its command by so much.
const OTHER: f64 = 1.5;

/// Relation of a joint's positions to its command: delay and gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed {
    /// Delay of the position after the command, s; negative where the command comes after the motion.
    pub late: f64,
    /// Gain of the position over the command.
    pub gain: f64,
}

/// Relation of a joint's positions to its command. None without a command, for a joint that does not move, and where
/// the command does not explain the motion.
pub fn followed(recording: &Recording, joint: usize) -> Option<Followed> {
    let command = recording.q_ref.as_ref()?.column(joint);
    if !moves(recording, joint) {
        return None;
    }
    let time = &recording.time;
    let every = recording.len().div_ceil(MOST).max(1);
    let lags = (-(FARTHEST / STEP) as i64..=(FARTHEST / STEP) as i64).map(|k| k as f64 * STEP);
    let of = |late: f64| {
        let [mut n, mut sx, mut sy, mut sxx, mut sxy, mut syy] = [0.0; 6];
        for t in &recording.trajectories {
            let mut at = t.range.start;
            for row in t.range.clone().step_by(every) {
                let when = time[row] - late;
                while at + 2 < t.range.end && time[at + 1] < when {
                    at += 1;
                }
                if when < time[at] || when > time[at + 1] {
                    continue;
                }
                let part = (when - time[at]) / (time[at + 1] - time[at]);
                let x = command[at] + part * (command[at + 1] - command[at]);
                let y = recording.q[(row, joint)];
                n += 1.0;
                sx += x;
                sy += y;
                sxx += x * x;
                sxy += x * y;
                syy += y * y;
            }
        }
        let (vx, vy, c) = (sxx - sx * sx / n, syy - sy * sy / n, sxy - sx * sy / n);
        let explained = c * c / (vx * vy);
        (explained.is_finite() && n > 1.0).then_some((explained, c / vx))
    };
    let best = lags
        .filter_map(|late| Some((late, of(late)?)))
        .max_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
    let (late, (explained, gain)) = best;
    (explained > EXPLAINED).then_some(Followed { late, gain })
}

/// Findings on the command: another unit, another clock.
pub(super) fn findings(recording: &Recording, names: &[String]) -> Vec<Finding> {
    let known: Vec<(usize, Followed)> = (0..recording.dof())
        .filter_map(|j| Some((j, followed(recording, j)?)))
        .collect();
    let mut found = Vec::new();
    let mut say = |joint: Option<usize>, value: f64, message: String| {
        found.push(Finding {
            kind: Kind::Command,
            severity: Severity::Severe,
            joint,
            row: None,
            value,
            parameters: Vec::new(),
            message,
        });
    };
    let late = signal::quantile::median(known.iter().map(|(_, f)| f.late).collect());
    if let Some(late) = late.filter(|l| *l < -EARLY || *l > LATE) {
        let text = if late < 0.0 {
            format!(
                "the command comes {:.2} s after the motion that it asks for: its stamps are of another clock, or the columns of another run",
                -late
            )
        } else {
            format!(
                "the motion comes {late:.2} s after its command, later than any controller: the stamps are of another clock"
            )
        };
        say(None, late, text);
    }
    let size = signal::quantile::median(known.iter().map(|(_, f)| f.gain.abs()).collect());
    match size {
        Some(size) if !(1.0 / OTHER..OTHER).contains(&size) => {
            let near = |unit: f64| (size / unit).ln().abs() < OTHER.ln();
            let what = if near(180.0 / PI) {
                "it is multiplied by π/180 once too often"
            } else if near(PI / 180.0) {
                "it is in degrees, the position in rad"
            } else {
                "it is in another unit"
            };
            let text = format!("the position is {size:.3} times its command: {what}");
            say(None, size, text);
        }
        _ => {
            for (j, f) in known
                .iter()
                .filter(|(_, f)| !(1.0 / OTHER..OTHER).contains(&f.gain))
            {
                let text = format!(
                    "{}: the position is {:.3} times its command; check its unit and direction",
                    names[*j], f.gain
                );
                say(Some(*j), f.gain, text);
            }
        }
    }
    found
}
