//! Readers: one per file format, all with the same checks behind them.

mod csv;
mod mat;
mod parquet;

use crate::{ColumnMap, Problem, ReadError, Recording, TorqueFilter};
use std::path::Path;

/// Which part of a file that holds both (the benchmark's .mat files).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Part {
    /// Training part: what `--data` takes.
    #[default]
    Train,
    /// Test part: what `--heldout` and `eval` take.
    Test,
}

/// How to read a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Joints of the robot; `None` takes what the file has.
    pub dof: Option<usize>,
    /// Part of a .mat file.
    pub part: Part,
    /// Whether a recording without torque is refused. Prediction alone does without.
    pub torque_needed: bool,
    /// Names and units of the columns.
    pub columns: ColumnMap,
    /// Low-pass that recordings of this robot went through; see [`TorqueFilter`] for when it
    /// applies.
    pub torque_filter: Option<TorqueFilter>,
    /// The robot is the KR300 of the benchmark: its .mat files may be read.
    pub kr300: bool,
}

impl ReadOptions {
    /// For a robot with `dof` joints whose torque is needed.
    pub fn for_robot(dof: usize) -> Self {
        Self {
            dof: Some(dof),
            torque_needed: true,
            ..Self::default()
        }
    }

    /// For `--robot kr300`: six joints, the benchmark's files and its torque filter.
    pub fn kr300(part: Part) -> Self {
        Self {
            part,
            torque_filter: Some(TorqueFilter::KR300),
            kr300: true,
            ..Self::for_robot(6)
        }
    }
}

/// Reads a recording; the ending of the name decides on the format.
///
/// # Errors
/// [`ReadError`] for a file that cannot be used, with the place and what to do. Nothing is
/// repaired: no value is made up and no row is left out.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Recording, ReadError> {
    let ending = path
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or("")
        .to_ascii_lowercase();
    let reader: fn(&[u8], &Path, &ReadOptions) -> Result<Recording, ReadError> =
        match ending.as_str() {
            "csv" => csv::read,
            "parquet" => parquet::read,
            "mat" => mat::read,
            _ => return Err(Problem::UnknownFormat(ending).in_file(path)),
        };
    let bytes = std::fs::read(path).map_err(|e| Problem::Io(e).in_file(path))?;
    reader(&bytes, path, options)
}
