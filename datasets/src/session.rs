//! Recordings of one session on one clock.
//!
//! Friction memory and warm-up run on through a session in order of time, over the breaks, and
//! over all its recordings: the held-out one may lie between the others. Recordings share a clock
//! when their trajectories, laid side by side, do not overlap and the later parts do not start
//! anew: see [`on_one_clock`].

use crate::Recording;
use std::ops::Range;

/// Longest pause in s for which one recording can be said to go on where another ends.
///
/// Interleaved recordings need no such limit: their order proves the clock.
pub const LONGEST_PAUSE_S: f64 = 3600.0;

/// A trajectory among several recordings.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Index of the recording.
    pub recording: usize,
    /// Index of the trajectory in it.
    pub trajectory: usize,
    /// Rows of that recording.
    pub range: Range<usize>,
    /// Pause since the end of the step before in s; `None` where memory starts neutral.
    pub pause: Option<f64>,
}

/// First and last stamp of every trajectory.
fn spans(recording: &Recording) -> impl Iterator<Item = [f64; 2]> + '_ {
    let time = &recording.time;
    recording
        .trajectories
        .iter()
        .map(|t| [time[t.range.start], time[t.range.end - 1]])
}

/// Whether the clock of a recording runs on over its breaks.
pub fn clock_runs_on(recording: &Recording) -> bool {
    let spans: Vec<_> = spans(recording).collect();
    spans.windows(2).all(|w| w[1][0] > w[0][1])
}

/// Whether two recordings share a clock.
///
/// Each clock runs on by itself, no trajectories overlap, and either they interleave or the second
/// begins no more than [`LONGEST_PAUSE_S`] after the end of the first. Two recordings that both
/// begin at zero overlap and so share no clock.
pub fn on_one_clock(a: &Recording, b: &Recording) -> bool {
    if a.is_empty() || b.is_empty() || !clock_runs_on(a) || !clock_runs_on(b) {
        return false;
    }
    let mut all: Vec<([f64; 2], bool)> = spans(a)
        .map(|s| (s, true))
        .chain(spans(b).map(|s| (s, false)))
        .collect();
    all.sort_by(|x, y| x.0[0].total_cmp(&y.0[0]));
    if all.windows(2).any(|w| w[1].0[0] <= w[0].0[1]) {
        return false;
    }
    let changes: Vec<_> = all.windows(2).filter(|w| w[0].1 != w[1].1).collect();
    changes.len() > 1
        || changes
            .iter()
            .all(|w| w[1].0[0] - w[0].0[1] <= LONGEST_PAUSE_S)
}

/// Order in which states with memory run through all recordings.
///
/// Recordings that share a clock (directly or through a third) are merged in order of time; the
/// others follow in the order given, each starting neutral (`pause` = `None`). Within a recording
/// whose own clock restarts, memory runs on over its breaks in row order with a pause of zero.
pub fn order(recordings: &[&Recording]) -> Vec<Step> {
    let mut session: Vec<usize> = (0..recordings.len()).collect();
    for i in 0..recordings.len() {
        for j in 0..i {
            if session[i] != session[j] && on_one_clock(recordings[j], recordings[i]) {
                let (from, to) = (session[i].max(session[j]), session[i].min(session[j]));
                session
                    .iter_mut()
                    .filter(|s| **s == from)
                    .for_each(|s| *s = to);
            }
        }
    }
    let mut steps = Vec::new();
    for number in 0..recordings.len() {
        let members: Vec<usize> = (0..recordings.len())
            .filter(|&i| session[i] == number)
            .collect();
        let mut part: Vec<([f64; 2], Step)> = members
            .iter()
            .flat_map(|&recording| {
                let ranges = recordings[recording]
                    .trajectories
                    .iter()
                    .map(|t| t.range.clone());
                spans(recordings[recording]).zip(ranges).enumerate().map(
                    move |(trajectory, (span, range))| {
                        (
                            span,
                            Step {
                                recording,
                                trajectory,
                                range,
                                pause: None,
                            },
                        )
                    },
                )
            })
            .collect();
        if members.len() > 1 {
            part.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        }
        for i in 1..part.len() {
            part[i].1.pause = Some((part[i].0[0] - part[i - 1].0[1]).max(0.0));
        }
        steps.extend(part.into_iter().map(|(_, step)| step));
    }
    steps
}
