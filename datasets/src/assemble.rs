//! From the columns of a file to a [`Recording`]: units, breaks, and every check of the values.

use crate::columns::{Group, Layout, Role};
use crate::{Problem, ReadError, ReadOptions, Recording, Trajectory};
use ndarray::Array2;
use std::collections::BTreeMap;
use std::path::Path;

/// Fewest samples of a trajectory: the padding of the zero-phase filters needs 16 (order 4), the
/// quintic spline 6, and a cut-off cannot be judged on less.
pub const MIN_SAMPLES: usize = 20;

/// A jump of the clock by more than this many median steps is a break.
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
    /// One per [`Layout::used`] that is not a label, in the same order.
    pub numbers: Vec<Vec<f64>>,
    pub labels: Option<LabelRuns>,
    /// Line of the first data row and lines per row of a text file; `None` for binary ones.
    pub lines: Option<Vec<u64>>,
    /// Filter that the file itself names; `Some(None)`: it says that there is none.
    pub torque_filter: Option<Option<crate::TorqueFilter>>,
}

/// Builds the recording.
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
        torque_filter,
    } = columns;
    let place = |mut error: ReadError, row: usize| {
        error.row = Some(row + 1);
        error.line = lines.as_ref().and_then(|l| l.get(row).copied());
        error
    };
    let mut time = Vec::new();
    let mut tables: BTreeMap<Group, Array2<f64>> = BTreeMap::new();
    let with_numbers = layout.used.iter().filter(|u| u.role != Role::Label);
    for (column, mut values) in with_numbers.zip(numbers) {
        if values.is_empty() {
            return Err(Problem::Empty.in_file(file));
        }
        if let Some(row) = values.iter().position(|v| !v.is_finite()) {
            let problem = Problem::NotFinite(values[row]);
            return Err(place(problem.in_column(file, &column.name), row));
        }
        match column.role {
            Role::Time => {
                if let Some(scale) = options.columns.time_scale {
                    values.iter_mut().for_each(|t| *t *= scale);
                }
                time = values;
            }
            Role::Joint(group, joint) => {
                let unit = options.columns.conversion(group, joint);
                let rows = values.len();
                let table = tables
                    .entry(group)
                    .or_insert_with(|| Array2::zeros((rows, layout.dof)));
                for (cell, v) in table.column_mut(joint).iter_mut().zip(values) {
                    *cell = unit.apply(v);
                }
            }
            Role::Label => {}
        }
    }
    let labelled = match labels {
        Some(runs) => runs.into_trajectories(),
        None => vec![Trajectory {
            label: "0".to_owned(),
            range: 0..time.len(),
        }],
    };
    for t in &labelled {
        for row in t.range.clone().skip(1) {
            if time[row] <= time[row - 1] {
                let problem = Problem::TimeNotIncreasing {
                    from: time[row - 1],
                    to: time[row],
                    trajectory: t.label.clone(),
                };
                let name = options.columns.single("time");
                return Err(place(problem.in_column(file, &name), row));
            }
        }
        if t.range.len() < MIN_SAMPLES {
            let problem = Problem::TooShort {
                trajectory: t.label.clone(),
                samples: t.range.len(),
                needed: MIN_SAMPLES,
            };
            return Err(place(problem.in_file(file), t.range.start));
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
        temp: tables.remove(&Group::Temp),
        ..Recording::new(
            &file.display().to_string(),
            time,
            q,
            tables.remove(&Group::Tau),
        )
    };
    recording.trajectories = labelled;
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
