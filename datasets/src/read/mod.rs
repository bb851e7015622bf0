//! Readers: one per file format, all with the same checks behind them.

mod contained;
mod csv;
mod footer;
mod mat;
mod npy;
mod npz;
mod parquet;

use crate::{ColumnMap, DeclaredFilter, Problem, ReadError, Recording, TorqueFilter};
use std::path::Path;

pub use mat::GEAR_RATIOS as KR300_GEAR_RATIOS;
pub(crate) use parquet::TORQUE_FILTER_KEY;

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
    /// Low-pass that recordings of this robot are declared to have been through.
    pub torque_filter: Option<DeclaredFilter>,
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
            torque_filter: Some(TorqueFilter::KR300.decimated()),
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
    let format = Format::of(path)?;
    let bytes = std::fs::read(path).map_err(|e| Problem::Io(e).in_file(path))?;
    read_bytes(&bytes, format, path, options)
}

/// A format of recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Text with commas.
    Csv,
    /// Apache Parquet.
    Parquet,
    /// NumPy archive.
    Npz,
    /// The KR300 benchmark's MATLAB files.
    Mat,
}

impl Format {
    /// The format that the ending of a name stands for.
    ///
    /// # Errors
    /// An ending that is none of them.
    pub fn of(path: &Path) -> Result<Self, ReadError> {
        let ending = path
            .extension()
            .and_then(|e| e.to_str())
            .unwrap_or("")
            .to_ascii_lowercase();
        match ending.as_str() {
            "csv" => Ok(Self::Csv),
            "parquet" => Ok(Self::Parquet),
            "npz" => Ok(Self::Npz),
            "mat" => Ok(Self::Mat),
            _ => Err(Problem::UnknownFormat(ending).in_file(path)),
        }
    }
}

/// Reads a recording from memory; `name` stands for the file in messages.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(
    bytes: &[u8],
    format: Format,
    name: &Path,
    options: &ReadOptions,
) -> Result<Recording, ReadError> {
    match format {
        Format::Csv => csv::read(bytes, name, options),
        Format::Parquet => parquet::read(bytes, name, options),
        Format::Npz => npz::read(bytes, name, options),
        Format::Mat => mat::read(bytes, name, options),
    }
}
