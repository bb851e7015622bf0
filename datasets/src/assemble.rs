//! Conversion of a file's columns into a [`Recording`]: units, breaks, and every check of the values.

use crate::columns::{Affine, Group, Layout, Role};
use crate::recording::MIN_SAMPLES;
use crate::stamps::{self, Clock};
use crate::{Problem, ReadError, ReadOptions, Recording, Trajectory, held, sources};
use ndarray::Array2;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::Path;

/// Number of median steps from which a jump of the clock is a break.
const BREAK_STEPS: f64 = 10.0;

/// Labels as runs: a recording has millions of rows and few labels.
#[derive(Clone, Debug, Default)]
pub(crate) struct LabelRuns {
    runs: Vec<(String, usize)>,
    rows: usize,
}

impl LabelRuns {
    pub fn push(&mut self, label: &str) {
        self.rows += 1;
        match self.runs.last_mut() {
            Some((last, end)) if last == label => *end = self.rows,
            _ => self.runs.push((label.to_owned(), self.rows)),
        }
    }

    fn into_trajectories(self) -> Vec<Trajectory> {
        let mut start = 0;
        self.runs
            .into_iter()
            .map(|(label, end)| {
                let range = start..end;
                start = end;
                Trajectory { label, range }
            })
            .collect()
    }
}

/// Columns of a file as read, before any conversion.
pub(crate) struct Columns {
    /// Columns of numbers, one per [`Layout::used`] that is not a label, in the same order; NaN where a value is missing.
    pub numbers: Vec<Vec<f64>>,
    /// Cells of `numbers` (column, row) that held nothing at all.
    pub empty: BTreeSet<(usize, usize)>,
    pub labels: Option<LabelRuns>,
    /// Line of the first data row and lines per row of a text file; `None` for binary ones.
    pub lines: Option<Vec<u64>>,
    /// Torque filter that the file itself names. `Some(None)`: the file states that the torque is unfiltered.
    pub torque_filter: Option<Option<crate::TorqueFilter>>,
}

/// Largest number that is taken for a value: no counter of 64 bits and no sensor gives a larger one. Beyond it
/// the cell holds what lay in memory before.
const LARGEST: f64 = 18_446_744_073_709_551_615.0;

/// Whether a number may be a measurement.
fn is_value(value: f64) -> bool {
    value.abs() <= LARGEST && !value.is_subnormal()
}

/// Rows of holes of the log, in which values are missing in at least as many consecutive rows as a trajectory
/// needs. Shorter gaps are damage, which is refused.
struct Holes {
    rows: Vec<bool>,
}

impl Holes {
    fn of(numbers: &[Vec<f64>]) -> Self {
        let count = numbers.first().map_or(0, Vec::len);
        let mut rows: Vec<bool> = (0..count)
            .map(|row| {
                numbers
                    .iter()
                    .any(|c| c.get(row).is_some_and(|v| v.is_nan()))
            })
            .collect();
        let mut start = 0;
        while start < count {
            let end = (start..count)
                .find(|&r| rows[r] != rows[start])
                .unwrap_or(count);
            if end - start < MIN_SAMPLES {
                rows[start..end].fill(false);
            }
            start = end;
        }
        Self { rows }
    }

    fn kept<T>(&self, values: Vec<T>) -> Vec<T> {
        let kept = values.into_iter().zip(&self.rows);
        kept.filter(|(_, hole)| !**hole).map(|(v, _)| v).collect()
    }

    /// The trajectories of the rows that are kept, broken at the holes.
    fn split(&self, trajectories: Vec<Trajectory>) -> Vec<Trajectory> {
        let mut pieces = Vec::with_capacity(trajectories.len());
        let mut at = 0;
        for Trajectory { label, range } in trajectories {
            let mut start = at;
            for row in range.clone() {
                let closes = self.rows[row] || row + 1 == range.end;
                at += usize::from(!self.rows[row]);
                if closes && at > start {
                    pieces.push(Trajectory {
                        label: label.clone(),
                        range: start..at,
                    });
                    start = at;
                }
            }
        }
        pieces
    }

    fn note(&self, count: usize) -> Option<String> {
        let lost = self.rows.iter().filter(|hole| **hole).count();
        let begins = |&row: &usize| self.rows[row] && (row == 0 || !self.rows[row - 1]);
        let first = (0..count).find(begins)?;
        let holes = (0..count).filter(begins).count();
        Some(format!(
            "{lost} rows without values in {holes} stretches, the first from row {}, are left out; trajectories are broken there",
            first + 1
        ))
    }
}

/// Builds a recording from the columns of a file.
pub(crate) fn assemble(
    layout: &Layout,
    columns: Columns,
    options: &ReadOptions,
    file: &Path,
) -> Result<Recording, ReadError> {
    let Columns {
        numbers,
        labels,
        lines,
        empty,
        torque_filter,
    } = columns;
    let rows = numbers.first().map_or(0, Vec::len);
    if rows == 0 {
        return Err(Problem::Empty.in_file(file));
    }
    let place = |mut error: ReadError, row: usize| {
        error.row = Some(row + 1);
        error.line = lines.as_ref().and_then(|l| l.get(row).copied());
        error
    };
    let labelled = match labels {
        Some(runs) => runs.into_trajectories(),
        None => vec![Trajectory {
            label: "0".to_owned(),
            range: 0..rows,
        }],
    };
    let mut notes = layout.notes.clone();
    let holes = Holes::of(&numbers);
    notes.extend(holes.note(rows));
    let mut clocks: Vec<Clock> = Vec::new();
    let mut tables: BTreeMap<Group, Array2<f64>> = BTreeMap::new();
    let with_numbers = layout.used.iter().filter(|u| u.role != Role::Label);
    for (at, (column, values)) in with_numbers.zip(numbers).enumerate() {
        let bad = |row: &usize| !holes.rows[*row] && !is_value(values[*row]);
        if let Some(row) = (0..rows).find(bad) {
            let problem = match values[row] {
                _ if empty.contains(&(at, row)) => Problem::MissingValue,
                value if value.is_finite() => Problem::Unfilled(value),
                value => Problem::NotFinite(value),
            };
            return Err(place(problem.in_column(file, &column.name), row));
        }
        let values: Vec<f64> = holes.kept(values);
        match column.role {
            Role::Time => clocks.push(Clock {
                name: column.name.clone(),
                stamps: values,
                unit: column.unit.map(|u| u.scale),
            }),
            Role::Nanoseconds => {
                if let Some(clock) = clocks.last_mut() {
                    let both = clock.stamps.iter_mut().zip(values);
                    both.for_each(|(seconds, ns)| *seconds += 1e-9 * ns);
                    clock.unit = Some(1.0);
                }
            }
            Role::Joint(group, joint) => {
                let unit = column.unit.unwrap_or(Affine::IDENTITY);
                let table = tables
                    .entry(group)
                    .or_insert_with(|| Array2::zeros((values.len(), layout.dof)));
                for (cell, v) in table.column_mut(joint).iter_mut().zip(values) {
                    *cell = unit.apply(v);
                }
            }
            Role::Label => {}
        }
    }
    let row_of = holes.kept((0..rows).collect());
    let labelled = holes.split(labelled);
    let breaks: Vec<usize> = labelled.iter().map(|t| t.range.start).collect();
    let chosen = stamps::choose(clocks, &breaks);
    let (clock, time) = match (chosen, options.rate_hz) {
        (Some(chosen), _) => {
            notes.extend(chosen.notes);
            (chosen.name, chosen.seconds)
        }
        (None, Some(rate)) => {
            notes.push(format!("no column is a time: rows are taken at {rate} Hz"));
            let even = row_of.iter().map(|&row| row as f64 / rate);
            ("rate".to_owned(), even.collect())
        }
        (None, None) => return Err(Problem::Empty.in_file(file)),
    };
    for t in &labelled {
        for row in t.range.clone().skip(1) {
            if time[row] <= time[row - 1] {
                let problem = Problem::TimeNotIncreasing {
                    from: time[row - 1],
                    to: time[row],
                    trajectory: t.label.clone(),
                };
                return Err(place(problem.in_column(file, &clock), row_of[row]));
            }
        }
        if t.range.len() < MIN_SAMPLES {
            let problem = Problem::TooShort {
                trajectory: t.label.clone(),
                samples: t.range.len(),
                needed: MIN_SAMPLES,
            };
            return Err(place(problem.in_file(file), row_of[t.range.start]));
        }
    }
    // A torque that nothing needs may be as it is.
    if let Some(tau) = tables.get(&Group::Tau).filter(|_| options.torque_needed) {
        let ranges: Vec<Range<usize>> = labelled.iter().map(|t| t.range.clone()).collect();
        if let Some((second, row)) = sources::second(tau, &ranges) {
            let zeros = second == sources::Second::Zeros;
            return Err(place(
                Problem::TwoSources { zeros }.in_file(file),
                row_of[row],
            ));
        }
    }
    let Some(q) = tables.remove(&Group::Q) else {
        return Err(Problem::Empty.in_file(file));
    };
    let mut recording = Recording {
        ql: tables.remove(&Group::Ql),
        qd: tables.remove(&Group::Qd),
        qdd: tables.remove(&Group::Qdd),
        q_ref: tables.remove(&Group::QRef),
        qd_ref: tables.remove(&Group::QdRef),
        tau_ff: tables.remove(&Group::TauFf),
        temp: tables.remove(&Group::Temp),
        ..Recording::new(
            &file.display().to_string(),
            time,
            q,
            tables.remove(&Group::Tau),
        )
    };
    recording.trajectories = labelled;
    recording.notes = notes;
    recording = held::released(recording);
    recording.trajectories = split_at_jumps(recording.trajectories, &recording.time);
    let step = recording.median_step();
    recording.torque_filter = match torque_filter {
        Some(own) => own,
        None => options
            .torque_filter
            .filter(|f| 1.0 / step <= f.up_to_hz)
            .map(|f| f.filter),
    };
    Ok(recording)
}

/// Breaks trajectories where the clock jumps forward, so that nothing is filtered over a hole.
/// A piece too short for the filters stays with its neighbour; the recording check names it.
fn split_at_jumps(trajectories: Vec<Trajectory>, time: &[f64]) -> Vec<Trajectory> {
    let mut pieces = Vec::with_capacity(trajectories.len());
    for Trajectory { label, range } in trajectories {
        // Its own: trajectories of one file may differ in rate.
        let steps = time[range.clone()].windows(2).map(|w| w[1] - w[0]);
        let step = signal::quantile::median(steps.collect()).unwrap_or(f64::NAN);
        let mut start = range.start;
        for row in range.start + MIN_SAMPLES..(range.end + 1).saturating_sub(MIN_SAMPLES) {
            if time[row] - time[row - 1] > BREAK_STEPS * step && row - start >= MIN_SAMPLES {
                pieces.push(Trajectory {
                    label: label.clone(),
                    range: start..row,
                });
                start = row;
            }
        }
        pieces.push(Trajectory {
            label,
            range: start..range.end,
        });
    }
    pieces
}
