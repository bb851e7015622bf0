//! NumPy archives: one array per column group.
//!
//! `time` (samples), `q`, `tau`, … (samples × joints), `trajectory` (samples; integers, text or numbers).
//! Arrays of single columns (`q1`, `tau3`, …) are understood as well, and other names with a clear meaning
//! (`positions`, `torques`, `times`).

use super::npy::{Array, Values};
use crate::assemble::{Columns, LabelRuns, assemble};
use crate::columns::{Group, Layout, Role};
use crate::{Problem, ReadError, ReadOptions, Recording};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Cursor, Read};
use std::path::Path;

/// Largest array that is unpacked, in bytes: guards against an archive that claims to be huge.
const LARGEST: u64 = 8 << 30;

/// Column of an array in the archive.
#[derive(Clone, Copy)]
struct Place<'a> {
    array: &'a Array,
    column: usize,
}

/// Reads a .npz file held in memory.
pub(crate) fn read(
    bytes: &[u8],
    file: &Path,
    options: &ReadOptions,
) -> Result<Recording, ReadError> {
    if bytes.is_empty() {
        return Err(Problem::Empty.in_file(file));
    }
    let arrays = unpack(bytes, file)?;
    let mut header = Vec::new();
    let mut places = Vec::new();
    for (name, array) in &arrays {
        match array.shape[..] {
            [_] => {
                header.push(name.clone());
                places.push(Place { array, column: 0 });
            }
            [_, columns] => {
                // A group, or the file's own name for one: `q` becomes q1, q2, …
                let pattern = group_pattern(name, options);
                for column in 0..columns {
                    header.push(pattern.replace("{}", &(column + 1).to_string()));
                    places.push(Place { array, column });
                }
            }
            // Scalars and cubes are other things that someone stored beside the recording.
            _ => {}
        }
    }
    let layout = Layout::resolve(&header, options, file)?;
    let rows = layout
        .used
        .first()
        .map_or(0, |u| places[u.index].array.shape[0]);
    let mut numbers = Vec::new();
    let mut labels = None;
    for used in &layout.used {
        let Place { array, column } = places[used.index];
        if array.shape[0] != rows {
            let needed = format!("{rows} rows, as `{}` has", layout.used[0].name);
            let problem = Problem::Shape {
                found: array.shape.clone(),
                needed,
            };
            return Err(problem.in_column(file, &used.name));
        }
        let cells = (0..rows).map(|row| array.index(row, column));
        match (used.role, &array.values) {
            (Role::Label, Values::Text(text)) => {
                labels = Some(label_runs(cells.map(|i| text[i].clone())));
            }
            (Role::Label, Values::Integers(v)) => {
                labels = Some(label_runs(cells.map(|i| v[i].to_string())));
            }
            (Role::Label, Values::Reals(v)) => {
                labels = Some(label_runs(cells.map(|i| v[i].to_string())));
            }
            (_, Values::Reals(v)) => numbers.push(cells.map(|i| v[i]).collect()),
            (_, Values::Integers(v)) => numbers.push(cells.map(|i| v[i] as f64).collect()),
            (_, Values::Text(_)) => {
                return Err(Problem::ColumnType("text".to_owned()).in_column(file, &used.name));
            }
        }
    }
    let columns = Columns {
        numbers,
        labels,
        lines: None,
        empty: BTreeSet::new(),
        torque_filter: None,
    };
    assemble(&layout, columns, options, file)
}

fn label_runs(labels: impl Iterator<Item = String>) -> LabelRuns {
    let mut runs = LabelRuns::default();
    labels.for_each(|l| runs.push(&l));
    runs
}

/// Header names of the columns of a two-dimensional array.
fn group_pattern(name: &str, options: &ReadOptions) -> String {
    // A drive file may name the archive's arrays: `tau = "motor_current"`, with or without `{}`.
    let named = Group::ALL.into_iter().find(|g| {
        options
            .columns
            .names
            .get(g.name())
            .is_some_and(|n| n.replace("{}", "") == name)
    });
    match named {
        Some(group) => options.columns.names[group.name()].clone(),
        None => format!("{name}{{}}"),
    }
}

fn unpack(bytes: &[u8], file: &Path) -> Result<BTreeMap<String, Array>, ReadError> {
    let damaged = |detail: String| Problem::Damaged {
        format: "npz",
        detail,
    };
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes))
        .map_err(|e| damaged(e.to_string()).in_file(file))?;
    let mut arrays = BTreeMap::new();
    for index in 0..archive.len() {
        let entry = archive
            .by_index(index)
            .map_err(|e| damaged(e.to_string()).in_file(file))?;
        let Some(name) = entry.name().strip_suffix(".npy").map(str::to_owned) else {
            continue;
        };
        if entry.size() > LARGEST {
            let detail = format!("claims {} bytes", entry.size());
            return Err(damaged(detail).in_column(file, &name));
        }
        let mut unpacked = Vec::new();
        entry
            .take(LARGEST)
            .read_to_end(&mut unpacked)
            .map_err(|e| damaged(e.to_string()).in_column(file, &name))?;
        match Array::parse(&unpacked) {
            Ok(array) => {
                arrays.insert(name, array);
            }
            // Objects and records may lie beside a recording; a column that is needed and cannot
            // be read is then missing, and said to be.
            Err(super::npy::NpyError::Type(_)) => {}
            Err(e) => return Err(damaged(e.to_string()).in_column(file, &name)),
        }
    }
    Ok(arrays)
}

/// Names of the arrays in the archive.
pub(super) fn names(bytes: &[u8], file: &Path) -> Option<Vec<String>> {
    Some(unpack(bytes, file).ok()?.into_keys().collect())
}
