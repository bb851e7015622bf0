//! The two MATLAB files of the KR300 benchmark (Weigand et al. 2022, DOI 10.26204/DATA/5).
//!
//! `forward_identification_…`: `u_*` is the motor torque (6 × K), `y_*` the position (6 × K).
//! `inverse_identification_…`: `u_*` is position, velocity and acceleration (18 × K), `y_*` the
//! motor torque. Angles are in degrees, torques on the motor side. `time_*` is 1 × K.
//!
//! The official files have a uniform time vector and no marks: an execution takes 60.588 s and
//! begins and ends at rest. In re-aligned copies the clock jumps at every seam. Both are read;
//! executions are labelled `train00` … and `test00` … in file order.

use super::contained::contained;
use crate::assemble::{Columns, LabelRuns, assemble};
use crate::columns::{Affine, ColumnMap, Group, Layout};
use crate::{Part, Problem, ReadError, ReadOptions, Recording};
use matfile::{MatFile, NumericData};
use ndarray::{Array2, ArrayView1, ArrayView2, Axis};
use signal::quantile::median;
use std::path::Path;

/// Gear ratios of joints 1 to 6: factors from motor torque to link torque.
pub const GEAR_RATIOS: [f64; 6] = [
    1798.0 / 7.0,
    1872.0 / 7.0,
    757.0 / 3.0,
    221.0,
    5032.0 / 21.0,
    206_793.0 / 1340.0,
];

/// Length of an execution in s.
const EXECUTION_S: f64 = 60.588;

/// Number of median steps from which a longer step is a seam between executions.
const SEAM_STEPS: f64 = 1.5;

/// Fastest speed that counts as rest, in deg/s; executions move at up to 100 deg/s.
const REST_DEG_S: f64 = 0.5;

const JOINTS: usize = 6;

/// Reads one part of a .mat file held in memory.
///
/// The test part follows the training part on the session's clock. Where its own clock restarts
/// it is set behind the training part, with one more seam between them.
pub(crate) fn read(
    bytes: &[u8],
    file: &Path,
    options: &ReadOptions,
) -> Result<Recording, ReadError> {
    if !options.kr300 {
        return Err(Problem::MatNeedsKr300.in_file(file));
    }
    if bytes.is_empty() {
        return Err(Problem::Empty.in_file(file));
    }
    let damaged = |detail: String| {
        Problem::Damaged {
            format: "MATLAB",
            detail,
        }
        .in_file(file)
    };
    let mat = contained("MATLAB", file, || {
        MatFile::parse(bytes).map_err(|e| damaged(e.to_string()))
    })?;
    let part = match options.part {
        Part::Train => "train",
        Part::Test => "test",
    };
    let table = |name: String| table(&mat, &name, file);
    let u = table(format!("u_{part}"))?;
    let y = table(format!("y_{part}"))?;
    let mut time = table(format!("time_{part}"))?
        .into_iter()
        .collect::<Vec<_>>();
    let rows = time.len();
    for (name, t) in [("u", &u), ("y", &y)] {
        if t.ncols() != rows {
            let needed = format!("one column for each of the {rows} time stamps");
            let problem = Problem::Shape {
                found: t.shape().to_vec(),
                needed,
            };
            return Err(problem.in_column(file, &format!("{name}_{part}")));
        }
    }
    let names: &[Group] = match (u.nrows(), y.nrows()) {
        (6, 6) => &[Group::Tau, Group::Q],
        (18, 6) => &[Group::Q, Group::Qd, Group::Qdd, Group::Tau],
        (found, _) => {
            let needed = "6 rows (forward file) or 18 rows (inverse file)".to_owned();
            let problem = Problem::Shape {
                found: vec![found, rows],
                needed,
            };
            return Err(problem.in_column(file, &format!("u_{part}")));
        }
    };
    if options.part == Part::Test {
        let train: Vec<f64> = table("time_train".to_owned())?.into_iter().collect();
        continue_clock(&mut time, &train);
    }
    // Positions are the first six rows of `u` in the inverse file, `y` in the forward file.
    let q = if u.nrows() == JOINTS {
        y.view()
    } else {
        u.view().split_at(Axis(0), JOINTS).0
    };
    let labels = executions(&time, q, part, file)?;

    let header: Vec<String> = ["time".to_owned(), "trajectory".to_owned()]
        .into_iter()
        .chain(
            names
                .iter()
                .flat_map(|g| (1..=JOINTS).map(move |j| format!("{}{j}", g.name()))),
        )
        .collect();
    let map = ColumnMap {
        units: units(),
        ..ColumnMap::default()
    };
    let options = ReadOptions {
        columns: map,
        torque_needed: true,
        ..options.clone()
    };
    let layout = Layout::resolve(&header, &options, file)?;
    let stacked: Vec<ArrayView1<'_, f64>> = u.rows().into_iter().chain(y.rows()).collect();
    let numbers = layout
        .used
        .iter()
        .filter(|c| c.index != 1)
        .map(|c| match c.index {
            0 => time.clone(),
            i => stacked[i - 2].to_vec(),
        })
        .collect();
    // The torque of both files is filtered, whatever else the caller assumes.
    let torque_filter = Some(Some(crate::TorqueFilter::KR300));
    let columns = Columns {
        numbers,
        labels: Some(labels),
        lines: None,
        empty: std::collections::BTreeSet::new(),
        torque_filter,
    };
    assemble(&layout, columns, &options, file)
}

/// Conversions of each group's columns, one per joint: position, velocity and acceleration from degrees to radians, torque
/// from motor to link by [`GEAR_RATIOS`].
fn units() -> std::collections::BTreeMap<Group, Vec<Affine>> {
    let radians = Affine {
        scale: std::f64::consts::PI / 180.0,
        offset: 0.0,
    };
    let torque = GEAR_RATIOS
        .iter()
        .map(|&scale| Affine { scale, offset: 0.0 })
        .collect();
    [Group::Q, Group::Qd, Group::Qdd]
        .into_iter()
        .map(|g| (g, vec![radians; JOINTS]))
        .chain([(Group::Tau, torque)])
        .collect()
}

/// A named matrix with as many columns as samples.
fn table(mat: &MatFile, name: &str, file: &Path) -> Result<Array2<f64>, ReadError> {
    let array = mat.find_by_name(name).ok_or_else(|| {
        let present = mat
            .arrays()
            .iter()
            .map(|a| a.name().to_owned())
            .collect::<Vec<_>>()
            .join(", ");
        Problem::MissingColumn {
            missing: name.into(),
            present: present.into(),
            declare: None,
        }
        .in_file(file)
    })?;
    let values: Vec<f64> = match array.data() {
        NumericData::Double { real, imag: None } => real.clone(),
        NumericData::Single { real, imag: None } => real.iter().map(|&v| f64::from(v)).collect(),
        _ => {
            let problem = Problem::ColumnType("integer or complex".to_owned());
            return Err(problem.in_column(file, name));
        }
    };
    let shape = array.size().clone();
    let needed = || "one column per sample".to_owned();
    let wrong = |found: Vec<usize>| {
        Problem::Shape {
            found,
            needed: needed(),
        }
        .in_column(file, name)
    };
    // MATLAB stores column by column: one column here is one sample.
    let [rows, columns] = shape[..] else {
        return Err(wrong(shape));
    };
    let by_sample =
        Array2::from_shape_vec((columns, rows), values).map_err(|_| wrong(vec![rows, columns]))?;
    let table = by_sample.reversed_axes();
    // Some exports hold the transpose; there are always more samples than rows.
    Ok(if rows > columns {
        table.reversed_axes()
    } else {
        table
    })
}

/// Sets a clock that starts anew behind the training part.
fn continue_clock(time: &mut [f64], train: &[f64]) {
    let (Some(&start), Some(&end)) = (time.first(), train.last()) else {
        return;
    };
    if start > end || !end.is_finite() {
        return;
    }
    let steps: Vec<f64> = train.windows(2).map(|w| w[1] - w[0]).collect();
    let Some(step) = median(steps.clone()) else {
        return;
    };
    let seams = steps.into_iter().filter(|&s| s > SEAM_STEPS * step);
    let pause = median(seams.collect()).unwrap_or(step);
    if pause.is_finite() {
        time.iter_mut().for_each(|t| *t += end - start + pause);
    }
}

/// Labels of the executions: a new one at each seam of the clock or, where the clock has no seams, every 60.588 s.
fn executions(
    time: &[f64],
    q: ArrayView2<'_, f64>,
    part: &str,
    file: &Path,
) -> Result<LabelRuns, ReadError> {
    let steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
    let step = median(steps.clone()).unwrap_or(f64::NAN);
    let seamed = steps.iter().any(|&s| s > SEAM_STEPS * step);
    let mut labels = LabelRuns::default();
    let mut number = 0;
    for row in 0..time.len() {
        let begins = row > 0
            && if seamed {
                steps[row - 1] > SEAM_STEPS * step
            } else {
                // Half a step of slack: stamps are multiples of the step, borders are not.
                let executed = (time[row] - time[0] + 0.5 * step) / EXECUTION_S;
                executed as usize > number
            };
        if begins {
            number += 1;
            if !seamed {
                at_rest(q, row, step, file)?;
            }
        }
        labels.push(&format!("{part}{number:02}"));
    }
    Ok(labels)
}

/// Checks that the robot rests at a border.
fn at_rest(q: ArrayView2<'_, f64>, row: usize, step: f64, file: &Path) -> Result<(), ReadError> {
    for joint in 0..q.nrows() {
        let speed = (q[(joint, row)] - q[(joint, row - 1)]).abs() / step;
        if speed > REST_DEG_S {
            let problem = Problem::NotAtRest {
                seconds: EXECUTION_S,
                joint: joint + 1,
                speed_deg_s: speed,
            };
            return Err(problem.in_file(file).at_row(row));
        }
    }
    Ok(())
}
