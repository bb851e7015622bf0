//! Section of the page on how motion follows commands: lag and steady error of each joint, and responses to steps.

use crate::diagnosis::Outcome;
use crate::simulate::Track;
use crate::tracks::Replayed;
use report::figure::{Ink, Panel, Plot};
use report::{Cell, Column, Section, Table};
use std::ops::Range;

/// Longest lag that is tried, s.
const SLOWEST: f64 = 0.5;
/// Difference between successive lags that are tried, s.
const STEP: f64 = 0.005;

/// Time for which a command must be constant before a step, s.
const BEFORE: f64 = 0.2;
/// Time for which a command must be constant after a step, s.
const AFTER: f64 = 0.3;
/// Time after the start of a step that is shown, s.
const SHOWN: f64 = 1.0;

/// Longest time over which a command may change and count as one step, s.
const LONGEST: f64 = 0.3;

/// Least size of a step, as a part of the range of the joint's commands.
const LEAST: f64 = 0.05;

/// Motion that a curve or number is about.
#[derive(Clone, Copy)]
enum Motion {
    /// Recorded motion.
    Measured,
    /// Simulated motion: index 0 by the simulator as given, 1 by the corrected one.
    Simulated(usize),
}

/// Name, motion and colour of the curves.
const MOTIONS: [(&str, Motion, Ink); 3] = [
    ("measured", Motion::Measured, Ink::Measured),
    ("as given", Motion::Simulated(0), Ink::Series(1)),
    ("corrected", Motion::Simulated(1), Ink::Predicted),
];

impl Motion {
    /// Positions of joint `j` over the whole trajectory `k`.
    fn of(self, outcome: &Outcome, heldout: &Replayed, k: usize, j: usize) -> Vec<f64> {
        let (q, n) = (heldout.whole[k].q.column(j), heldout.tracking.len());
        match self {
            Self::Measured => q.to_vec(),
            Self::Simulated(which) => {
                let errors = outcome.errors[which][k].iter().skip(j).step_by(n);
                q.iter().zip(errors).map(|(q, e)| q + e).collect()
            }
        }
    }
}

/// Section with lag and steady error of each joint that moves, and its step responses where there are steps.
pub(super) fn following(outcome: &Outcome, heldout: &Replayed) -> Section {
    let joints = &outcome.report.joints;
    let mut table = Table::new([
        Column::text("joint"),
        Column::number("lag / ms"),
        Column::number("as given"),
        Column::number("corrected"),
        Column::number("droop / mrad (mm)"),
        Column::number("as given"),
        Column::number("corrected"),
    ]);
    let moving: Vec<usize> = (0..joints.len()).filter(|&j| heldout.moves[j]).collect();
    for &j in &moving {
        let each = MOTIONS.map(|(_, motion, _)| lag_and_droop(outcome, heldout, j, motion));
        let mut row = vec![Cell::text(joints[j].clone())];
        row.extend(each.map(|(lag, _)| Cell::optional(lag.map(|l| 1e3 * l), 0)));
        row.extend(each.map(|(_, droop)| Cell::number(1e3 * droop, 1)));
        table.push(row);
    }
    let section = Section::new("Lag and droop")
        .paragraph(
            "Lag is the time by which the motion repeats its commands best. Droop is what remains between them on average, command less \
             position: what gravity takes, or a zero that is off.",
        )
        .table(table);
    let figures = moving.into_iter().filter_map(|j| {
        let panel = answers(outcome, heldout, j)?;
        let plot = Plot::new(&joints[j], "time since the step / s").half_width();
        Some(plot.panel(panel).draw(format!(
            "{}: every held-out step of the command from 0 to 1, laid over each other",
            joints[j]
        )))
    });
    figures.fold(section, Section::figure)
}

/// Lag of joint `j`'s motion behind its command, s, and mean of command less position, rad (m). The lag is none where
/// the shifted command leaves more than half of the position's variance.
fn lag_and_droop(
    outcome: &Outcome,
    heldout: &Replayed,
    j: usize,
    motion: Motion,
) -> (Option<f64>, f64) {
    let motions: Vec<Vec<f64>> = (0..heldout.whole.len())
        .map(|k| motion.of(outcome, heldout, k, j))
        .collect();
    // Mean and variance of command less position at a lag, and variance of the position.
    let apart = |lag: f64| {
        let [mut n, mut sum, mut square, mut q_sum, mut q_square] = [0.0; 5];
        for (track, q) in heldout.whole.iter().zip(&motions) {
            for (t, q) in track.time.iter().zip(q) {
                if t - track.time[0] < SLOWEST {
                    continue;
                }
                let off = track.commands[j].value(t - lag) - q;
                n += 1.0;
                sum += off;
                square += off * off;
                q_sum += q;
                q_square += q * q;
            }
        }
        let mean = sum / n;
        let own: f64 = q_sum / n;
        (mean, square / n - mean * mean, q_square / n - own * own)
    };
    let lags = (0..=(SLOWEST / STEP) as usize).map(|i| i as f64 * STEP);
    let all = lags.map(|lag| (lag, apart(lag)));
    match all.min_by(|a, b| a.1.1.total_cmp(&b.1.1)) {
        Some((lag, (droop, left, whole))) => ((left < 0.5 * whole).then_some(lag), droop),
        None => (None, 0.0),
    }
}

/// Responses to the steps of joint `j`'s command, each scaled from 0 to 1; none where the command has no steps.
fn answers(outcome: &Outcome, heldout: &Replayed, j: usize) -> Option<Panel> {
    let mut panel = Panel::new("part of the step");
    let mut any = false;
    for (name, motion, ink) in MOTIONS {
        let (mut x, mut y, mut pieces) = (Vec::new(), Vec::new(), Vec::new());
        for (k, track) in heldout.whole.iter().enumerate() {
            let q = motion.of(outcome, heldout, k, j);
            for step in steps(track, j) {
                let from = x.len();
                for row in step.rows.clone() {
                    x.push(track.time[row] - step.time);
                    y.push((q[row] - step.from) / (step.to - step.from));
                }
                pieces.push(from..x.len());
            }
        }
        any |= !pieces.is_empty();
        panel = panel.segments(name, ink, &x, &y, &pieces);
    }
    any.then_some(panel)
}

/// Step of a joint's command.
struct Step {
    /// Time at which the command begins to change, s.
    time: f64,
    /// Command before the step, rad (m).
    from: f64,
    /// Command after the step, rad (m).
    to: f64,
    /// Rows of the track that are shown, from just before the step on.
    rows: Range<usize>,
}

/// Steps of joint `j`'s command: quick changes between two times at which it is constant for long enough.
fn steps(track: &Track, j: usize) -> Vec<Step> {
    let time = &track.time;
    let values: Vec<f64> = time.iter().map(|&t| track.commands[j].value(t)).collect();
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| {
            (a.min(*v), b.max(*v))
        });
    // Changes within a short time count as one, as some drives and recorders take a step in parts.
    let mut changes: Vec<Range<usize>> = Vec::new();
    for row in (1..values.len()).filter(|&r| values[r] != values[r - 1]) {
        match changes.last_mut() {
            Some(last) if time[row] - time[last.end - 1] < BEFORE => last.end = row + 1,
            _ => changes.push(row..row + 1),
        }
    }
    let mut out = Vec::new();
    for (i, change) in changes.iter().enumerate() {
        let before = if i == 0 { 0 } else { changes[i - 1].end - 1 };
        let next = changes.get(i + 1).map_or(time.len(), |c| c.start);
        let [start, end] = [time[change.start], time[change.end - 1]];
        let (from, to) = (values[change.start - 1], values[change.end - 1]);
        let holds = start - time[before] >= BEFORE && time[next - 1] - end >= AFTER;
        if holds && end - start <= LONGEST && (to - from).abs() >= LEAST * (high - low) {
            let shown = time.partition_point(|t| *t <= start + SHOWN).min(next);
            out.push(Step {
                time: start,
                from,
                to,
                rows: change.start - 1..shown,
            });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::{Command, Interpolation};
    use ndarray::Array2;

    #[test]
    fn only_commands_that_hold_before_and_after_are_steps() {
        let time: Vec<f64> = (0..400).map(|i| f64::from(i) * 0.01).collect();
        // A step at 1 s, one in two parts at 2 s, and a staircase of 50 ms from 3 s on.
        let command = |t: f64| match t {
            t if t < 1.0 => 0.0,
            t if t < 2.0 => 0.4,
            t if t < 2.1 => 0.2,
            t if t < 3.0 => 0.0,
            t => 0.1 * ((t - 3.0) / 0.05).floor(),
        };
        let track = Track {
            trajectory: 0,
            q: Array2::zeros((time.len(), 1)),
            start_velocity: vec![0.0],
            commands: vec![Command::new(
                &time,
                time.iter().map(|&t| command(t)).collect(),
                Interpolation::Hold,
            )],
            rates: None,
            added: None,
            time,
        };
        let found = steps(&track, 0);
        assert_eq!(found.len(), 2);
        assert!((found[0].time - 1.0).abs() < 1e-9 && found[0].to == 0.4);
        assert_eq!(found[0].rows, 99..200);
        assert!((found[1].time - 2.0).abs() < 1e-9 && found[1].to == 0.0);
    }
}
