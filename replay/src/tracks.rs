//! Preparation of recordings for replay: checks, trajectories to score and blocks to fit.

use crate::check::{Unusable, check, range};
use crate::command::{Command, Interpolation};
use crate::floor::repeatability;
use crate::simulate::Track;
use datasets::Recording;
use ndarray::{Array2, Axis, Slice};
use std::ops::Range;

/// Length of a block, s. A fit restarts the simulation from the recorded state at the start of every block. A block is
/// longer than a joint's transients, and short enough that a recording has enough blocks for parallel work and a
/// jackknife.
const BLOCK: f64 = 5.0;

/// Longest total length of the blocks that a fit uses, s. Of longer recordings, evenly spread blocks are left out.
const FITTED: f64 = 120.0;

/// Recordings prepared for replay: trajectories and blocks, with facts about each joint.
#[derive(Debug, Clone)]
pub struct Replayed {
    /// Whole trajectories. Errors are scored on them.
    pub whole: Vec<Track>,
    /// Blocks of the trajectories, of about five seconds. Parameters are fitted to them.
    pub blocks: Vec<Track>,
    /// RMS of command less recorded position of each joint, rad (m). Simulation errors are taken relative to it.
    pub tracking: Vec<f64>,
    /// Quantisation step of each joint's recorded position, rad (m); 0 where positions are not quantised.
    pub quantum: Vec<f64>,
    /// Whether the position or the command of each joint changes at all.
    pub moves: Vec<bool>,
    /// RMS difference of one execution of a motion from another over √2, by joint, rad (m); none where no motion is repeated.
    pub repeats: Option<Vec<f64>>,
}

impl Replayed {
    /// Adds another recording, to be fitted and scored together with this one.
    pub fn join(&mut self, other: Self) {
        let rows = |all: &[Track]| all.iter().map(|t| t.time.len()).sum::<usize>() as f64;
        let (own, more) = (rows(&self.whole), rows(&other.whole));
        for j in 0..self.tracking.len() {
            let square = own * self.tracking[j].powi(2) + more * other.tracking[j].powi(2);
            self.tracking[j] = (square / (own + more)).sqrt();
            self.quantum[j] = self.quantum[j].max(other.quantum[j]);
            self.moves[j] |= other.moves[j];
        }
        let larger = |(a, b): (&f64, &f64)| a.max(*b);
        self.repeats = match (self.repeats.take(), other.repeats) {
            (Some(a), Some(b)) => Some(a.iter().zip(&b).map(larger).collect()),
            (one, more) => one.or(more),
        };
        self.whole.extend(other.whole);
        let mut blocks = std::mem::take(&mut self.blocks);
        blocks.extend(other.blocks);
        self.blocks = thinned(blocks);
    }
}

/// Checks a recording and prepares it. Its trajectories are numbered from `first` on, so that several recordings can be
/// fitted together. `lags` says how late each joint follows by what is given of its drive, s.
///
/// # Errors
/// Fault of the recording that makes a replay impossible or meaningless.
pub fn prepare(
    recording: &Recording,
    interpolation: Interpolation,
    first: usize,
    lags: &[f64],
) -> Result<Replayed, Unusable> {
    let Some(command) = &recording.q_ref else {
        let source_name = recording.source.clone();
        return Err(Unusable::NoCommand { source_name });
    };
    let n = recording.dof();
    let quantum: Vec<f64> = (0..n).map(|j| quantum(recording, j)).collect();
    check(recording, command, &quantum, lags)?;
    let moves = (0..n)
        .map(|j| range(&recording.q, j) > 0.0 || range(command, j) > 0.0)
        .collect();
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
    let tracking: Vec<f64> = squared.iter().map(|s| (s / rows).sqrt()).collect();
    Ok(Replayed {
        whole,
        blocks: thinned(blocks),
        repeats: repeatability(recording, command, &tracking),
        tracking,
        quantum,
        moves,
    })
}

/// Evenly spread selection of the blocks, as many as together have the length `FITTED`; all where they are no more.
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

/// Track over the rows `part` of the trajectory with number `number`. Its commands cover the whole trajectory.
fn track(
    recording: &Recording,
    command: &Array2<f64>,
    interpolation: Interpolation,
    trajectory: &Range<usize>,
    part: Range<usize>,
    number: usize,
) -> Track {
    let n = recording.dof();
    // Commands of the whole trajectory: with a delay, those before the part act within it.
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
        added: recording.tau_ff.as_ref().map(commands),
    }
}

/// Values of one joint's column in some rows of a table.
fn part_of(table: &Array2<f64>, joint: usize, rows: &Range<usize>) -> Vec<f64> {
    table
        .column(joint)
        .iter()
        .skip(rows.start)
        .take(rows.len())
        .copied()
        .collect()
}

/// Time before and after a start from which samples are used for the velocity there, s. The acceleration is nearly
/// constant within it.
const AROUND: f64 = 0.02;

/// Velocity of a joint at row `at`, rad/s (m/s): slope there of the parabola through the samples around it, at least
/// two on either side. Recorded velocities are not used because their filter is unknown.
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

/// Quantisation step of a joint's positions, rad (m): the smallest difference other than zero between successive
/// samples. It is 0 where fewer than a twentieth of the differences vanish.
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
    // Differences below 1e-9 are rounding of the file, not an encoder's step.
    let least = steps
        .into_iter()
        .filter(|s| *s > 1e-9)
        .fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}
