//! From a recording to what is replayed, with the checks that a replay needs.

use crate::command::{Command, Interpolation};
use crate::simulate::Track;
use datasets::Recording;
use ndarray::{Array2, Axis, Slice};
use std::ops::Range;

/// Length of a block that a fit replays from its recorded start, s. Longer than any joint remembers, and short enough that
/// two cores and the intervals have blocks to share.
const BLOCK: f64 = 5.0;

/// Seconds of recording that are fitted; of longer ones blocks are left out evenly.
const FITTED: f64 = 120.0;

/// Why a recording cannot be replayed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unusable {
    /// No commanded positions.
    #[error(
        "{source_name} has no commanded positions; name them q_ref1 … in the file, or in the drive file: [columns] \
         q_ref = \"goal_{{}}\""
    )]
    NoCommand {
        /// Recording.
        source_name: String,
    },
    /// The command is the position itself.
    #[error(
        "{source_name}: the commands of joint {joint} equal its positions, sample by sample: the goal was not recorded; log \
         what was sent to the drive"
    )]
    Echo {
        /// Recording.
        source_name: String,
        /// Number of the joint, from 1.
        joint: usize,
    },
    /// Commands in another unit.
    #[error(
        "{source_name}: the commands of joint {joint} move {ratio:.4} times as far as its positions, which is {meaning}; \
         convert them, or give both in one unit"
    )]
    Unit {
        /// Recording.
        source_name: String,
        /// Number of the joint, from 1.
        joint: usize,
        /// Commanded range over range of positions.
        ratio: f64,
        /// What such a ratio is.
        meaning: &'static str,
    },
    /// Commands that belong to another time.
    #[error(
        "{source_name}: positions follow the commands {late:+.2} s late; shift one of the two clocks by that, as no drive is so \
         slow"
    )]
    Clock {
        /// Recording.
        source_name: String,
        /// By how much, s.
        late: f64,
    },
    /// Commands in another order.
    #[error(
        "{source_name}: the commands of joint {joint} fit the positions of joint {other} better than its own; check the \
         order of the q_ref columns"
    )]
    Order {
        /// Recording.
        source_name: String,
        /// Number of the joint, from 1.
        joint: usize,
        /// Number of the other joint.
        other: usize,
    },
    /// Nothing moves.
    #[error("{source_name}: no joint moves; a replay needs motion")]
    Still {
        /// Recording.
        source_name: String,
    },
}

/// The trajectories of a recording as they are replayed.
#[derive(Debug, Clone)]
pub struct Replayed {
    /// Whole trajectories: what is scored.
    pub whole: Vec<Track>,
    /// Blocks of them: what is fitted.
    pub blocks: Vec<Track>,
    /// By joint RMS(q_ref − q), rad (m).
    pub tracking: Vec<f64>,
    /// By joint the smallest step of its positions, rad; 0 where they are continuous.
    pub quantum: Vec<f64>,
    /// Whether each joint moves.
    pub moves: Vec<bool>,
}

impl Replayed {
    /// Adds another recording: its trajectories are fitted and scored beside the first one's.
    pub fn join(&mut self, other: Self) {
        let rows = |all: &[Track]| all.iter().map(|t| t.time.len()).sum::<usize>() as f64;
        let (own, more) = (rows(&self.whole), rows(&other.whole));
        for j in 0..self.tracking.len() {
            let square = own * self.tracking[j].powi(2) + more * other.tracking[j].powi(2);
            self.tracking[j] = (square / (own + more)).sqrt();
            self.quantum[j] = self.quantum[j].max(other.quantum[j]);
            self.moves[j] |= other.moves[j];
        }
        self.whole.extend(other.whole);
        let mut blocks = std::mem::take(&mut self.blocks);
        blocks.extend(other.blocks);
        self.blocks = thinned(blocks);
    }
}

/// Prepares a recording. Trajectories keep their numbers from `first` on, so that several recordings can be fitted together.
///
/// # Errors
/// What makes a replay impossible or meaningless, with what to do.
pub fn prepare(
    recording: &Recording,
    interpolation: Interpolation,
    first: usize,
) -> Result<Replayed, Unusable> {
    let source_name = recording.source.clone();
    let Some(command) = &recording.q_ref else {
        return Err(Unusable::NoCommand { source_name });
    };
    let n = recording.dof();
    check(recording, command)?;
    let moves: Vec<bool> = (0..n)
        .map(|j| {
            let spread = |table: &Array2<f64>| {
                let column = table.column(j);
                column.iter().fold(f64::NEG_INFINITY, |m, v| m.max(*v))
                    - column.iter().fold(f64::INFINITY, |m, v| m.min(*v))
            };
            spread(&recording.q) > 0.0 || spread(command) > 0.0
        })
        .collect();
    if !moves.contains(&true) {
        return Err(Unusable::Still { source_name });
    }
    let mut squared = vec![0.0; n];
    for row in 0..recording.len() {
        for j in 0..n {
            squared[j] += (command[(row, j)] - recording.q[(row, j)]).powi(2);
        }
    }
    let rows = recording.len() as f64;
    let mut whole = Vec::new();
    let mut blocks = Vec::new();
    for (k, trajectory) in recording.trajectories.iter().enumerate() {
        let range = trajectory.range.clone();
        if range.len() < 3 {
            continue;
        }
        let of =
            |part: Range<usize>| track(recording, command, interpolation, &range, part, first + k);
        whole.push(of(range.clone()));
        let span = recording.time[range.end - 1] - recording.time[range.start];
        let count = (span / BLOCK).round().max(1.0) as usize;
        for b in 0..count {
            let from = range.start + range.len() * b / count;
            let to = range.start + range.len() * (b + 1) / count;
            blocks.push(of(from..to));
        }
    }
    Ok(Replayed {
        whole,
        blocks: thinned(blocks),
        tracking: squared.iter().map(|s| (s / rows).sqrt()).collect(),
        quantum: (0..n).map(|j| quantum(recording, j)).collect(),
        moves,
    })
}

/// Every k-th block, where there are more than are fitted.
fn thinned(blocks: Vec<Track>) -> Vec<Track> {
    let most = (FITTED / BLOCK) as usize;
    let (count, most) = (blocks.len(), most.max(1));
    let keep = |i: usize| count <= most || (i * most) / count != (i * most + most) / count;
    blocks
        .into_iter()
        .enumerate()
        .filter(|(i, _)| keep(*i))
        .map(|(_, b)| b)
        .collect()
}

fn track(
    recording: &Recording,
    command: &Array2<f64>,
    interpolation: Interpolation,
    trajectory: &Range<usize>,
    part: Range<usize>,
    number: usize,
) -> Track {
    let n = recording.dof();
    // Commands before the part are known, as a delay needs them.
    let stamps = &recording.time[trajectory.clone()];
    let commands = |table: &Array2<f64>| -> Vec<Command> {
        (0..n)
            .map(|j| {
                let values = part_of(table, j, trajectory);
                Command::new(stamps, values, interpolation)
            })
            .collect()
    };
    Track {
        trajectory: number,
        time: recording.time[part.clone()].to_vec(),
        q: recording
            .q
            .slice_axis(Axis(0), Slice::from(part.clone()))
            .to_owned(),
        start_velocity: (0..n)
            .map(|j| start_velocity(recording, trajectory, part.start, j))
            .collect(),
        commands: commands(command),
        rates: recording.qd_ref.as_ref().map(commands),
    }
}

/// A joint's values in some rows.
fn part_of(table: &Array2<f64>, joint: usize, rows: &Range<usize>) -> Vec<f64> {
    table
        .column(joint)
        .iter()
        .skip(rows.start)
        .take(rows.len())
        .copied()
        .collect()
}

/// Time on either side of a start over which its velocity is taken, s: a joint's acceleration hardly changes within it.
const AROUND: f64 = 0.02;

/// Slope at the start of the parabola through the samples around it, five at least; a recorded velocity may be of another filter.
fn start_velocity(
    recording: &Recording,
    trajectory: &Range<usize>,
    at: usize,
    joint: usize,
) -> f64 {
    let near = |r: &usize| (recording.time[*r] - recording.time[at]).abs() <= AROUND;
    let before = (trajectory.start..at).rev().take_while(near).count().max(2);
    let after = (at + 1..trajectory.end).take_while(near).count().max(2);
    let rows =
        at.saturating_sub(before).max(trajectory.start)..(at + after + 1).min(trajectory.end);
    let mut normal = nalgebra::Matrix3::zeros();
    let mut right = nalgebra::Vector3::zeros();
    for r in rows {
        let t = (recording.time[r] - recording.time[at]) / AROUND;
        let powers = nalgebra::Vector3::new(1.0, t, t * t);
        normal += powers * powers.transpose();
        right += powers * (recording.q[(r, joint)] - recording.q[(at, joint)]);
    }
    normal
        .cholesky()
        .map_or(0.0, |c| c.solve(&right)[1] / AROUND)
}

/// Smallest difference between successive positions of a joint; 0 where hardly any are equal, as then none is quantised.
fn quantum(recording: &Recording, joint: usize) -> f64 {
    let steps: Vec<f64> = recording
        .segments()
        .into_iter()
        .flat_map(|range| {
            range
                .clone()
                .skip(1)
                .map(|r| (recording.q[(r, joint)] - recording.q[(r - 1, joint)]).abs())
        })
        .collect();
    let equal = steps.iter().filter(|s| **s == 0.0).count();
    if equal * 20 < steps.len() {
        return 0.0;
    }
    // Rounding of the file stands below any encoder.
    let least = steps
        .into_iter()
        .filter(|s| *s > 1e-9)
        .fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

/// Ratios of a commanded range to that of the positions that are a change of unit.
const UNITS: [(f64, &str); 3] = [
    (57.295_779_513, "degrees beside radians"),
    (
        1.0 / 57.295_779_513,
        "a conversion from degrees applied twice",
    ),
    (1000.0, "millimetres beside metres"),
];

fn check(recording: &Recording, command: &Array2<f64>) -> Result<(), Unusable> {
    let n = recording.dof();
    let source_name = recording.source.clone();
    let deviation = |table: &Array2<f64>, j: usize| {
        let column = table.column(j);
        let mean = column.mean().unwrap_or(0.0);
        (column.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / column.len() as f64).sqrt()
    };
    for j in 0..n {
        let (own, commanded) = (deviation(&recording.q, j), deviation(command, j));
        if own == 0.0 || commanded == 0.0 {
            continue;
        }
        let departs = recording
            .q
            .column(j)
            .iter()
            .zip(command.column(j))
            .any(|(q, c)| (q - c).abs() > 1e-9);
        if !departs {
            return Err(Unusable::Echo {
                source_name,
                joint: j + 1,
            });
        }
        let ratio = commanded / own;
        // A drive that follows at all keeps its range within half and twice the command's.
        if let Some((_, meaning)) = UNITS
            .iter()
            .find(|(u, _)| ratio / u > 0.5 && ratio / u < 2.0)
        {
            return Err(Unusable::Unit {
                source_name,
                joint: j + 1,
                ratio,
                meaning,
            });
        }
    }
    order(recording, command)?;
    clock(recording, command)
}

/// Refuses commands whose columns are exchanged: each fits the other joint's positions clearly better.
fn order(recording: &Recording, command: &Array2<f64>) -> Result<(), Unusable> {
    let n = recording.dof();
    let correlation = |a: usize, b: usize| {
        let (x, y) = (command.column(a), recording.q.column(b));
        let (mx, my) = (x.mean().unwrap_or(0.0), y.mean().unwrap_or(0.0));
        let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
        for (x, y) in x.iter().zip(y) {
            xy += (x - mx) * (y - my);
            xx += (x - mx).powi(2);
            yy += (y - my).powi(2);
        }
        if xx > 0.0 && yy > 0.0 {
            xy / (xx * yy).sqrt()
        } else {
            0.0
        }
    };
    for a in 0..n {
        for b in a + 1..n {
            let own = correlation(a, a).max(correlation(b, b));
            let other = correlation(a, b).min(correlation(b, a));
            // Exchanged columns follow closely where the joint's own do not follow at all.
            if other > 0.9 && own < 0.5 {
                return Err(Unusable::Order {
                    source_name: recording.source.clone(),
                    joint: a + 1,
                    other: b + 1,
                });
            }
        }
    }
    Ok(())
}

/// Longest delay of a drive that is believed, s.
const SLOWEST: f64 = 0.5;

/// Refuses commands whose clock is not that of the positions: the median delay over joints by cross-correlation.
fn clock(recording: &Recording, command: &Array2<f64>) -> Result<(), Unusable> {
    let step = recording.median_step();
    let Some(longest) = recording.trajectories.iter().max_by_key(|t| t.range.len()) else {
        return Ok(());
    };
    let range = longest.range.clone();
    let most = ((2.0 / step) as usize).min(range.len() / 4);
    let mut lates: Vec<f64> = (0..recording.dof())
        .filter_map(|j| {
            let q = part_of(&recording.q, j, &range);
            let c = part_of(command, j, &range);
            best_lag(&c, &q, most).map(|lag| lag as f64 * step)
        })
        .collect();
    if lates.is_empty() {
        return Ok(());
    }
    lates.sort_by(f64::total_cmp);
    let late = lates[lates.len() / 2];
    if late > SLOWEST || late < -2.0 * step.max(0.01) {
        return Err(Unusable::Clock {
            source_name: recording.source.clone(),
            late,
        });
    }
    Ok(())
}

/// Lag (samples) at which `b` repeats `a` best; none where it hardly does at any.
fn best_lag(a: &[f64], b: &[f64], most: usize) -> Option<isize> {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len().max(1) as f64;
    let (ma, mb) = (mean(a), mean(b));
    let at = |lag: isize| {
        let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
        for (i, x) in a.iter().enumerate() {
            let Some(y) = i.checked_add_signed(lag).and_then(|k| b.get(k)) else {
                continue;
            };
            ab += (x - ma) * (y - mb);
            aa += (x - ma).powi(2);
            bb += (y - mb).powi(2);
        }
        if aa > 0.0 && bb > 0.0 {
            ab / (aa * bb).sqrt()
        } else {
            0.0
        }
    };
    let most = most as isize;
    let best = (-most..=most).max_by(|x, y| at(*x).total_cmp(&at(*y)))?;
    (at(best) > 0.8).then_some(best)
}
