//! Readers: one per file format, all with the same checks behind them.

mod bag;
mod contained;
mod csv;
mod footer;
mod lerobot;
mod mat;
mod names;
mod npy;
mod npz;
mod parquet;
mod text;

use crate::{Problem, ReadError, ReadOptions, Recording};
use std::path::Path;

pub use bag::{TopicSummary, planned_trajectories};
pub use lerobot::{DatasetSummary, FeatureSummary, dataset};
pub use mat::GEAR_RATIOS as KR300_GEAR_RATIOS;
pub use names::named_joints;
pub(crate) use parquet::TORQUE_FILTER_KEY;

/// Reads a recording; the ending of the name decides on the format.
///
/// # Errors
/// [`ReadError`] for a file that cannot be used, with the place and what to do. Nothing is
/// repaired: no value is made up and no row is left out.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Recording, ReadError> {
    if lerobot::is_dataset(path) {
        return lerobot::read(path, options);
    }
    let format = Format::of(path)?;
    if format == Format::Bag {
        return bag::read(bag::Input::Path(path), path, options);
    }
    let bytes = std::fs::read(path).map_err(|e| Problem::Io(e).in_file(path))?;
    read_bytes(&bytes, format, path, options)
}

/// Lists the topics of a bag.
///
/// # Errors
/// [`ReadError`] for a file that cannot be read, or is not a bag.
pub fn topics(path: &Path) -> Result<Vec<TopicSummary>, ReadError> {
    match Format::of(path)? {
        Format::Bag => bag::topics(path),
        _ => Err(Problem::NoTopics.in_file(path)),
    }
}

/// Format of a recording's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Text in columns with a header (.csv and others).
    Csv,
    /// Apache Parquet file (.parquet).
    Parquet,
    /// NumPy archive (.npz).
    Npz,
    /// The KR300 benchmark's MATLAB files.
    Mat,
    /// MCAP file, or rosbag2's SQLite file or folder (the folder on disk alone, never in memory).
    Bag,
}

impl Format {
    /// Format by the ending of the file's name.
    ///
    /// # Errors
    /// An ending that no format has.
    pub fn of(path: &Path) -> Result<Self, ReadError> {
        if path.is_dir() {
            return Ok(Self::Bag);
        }
        let ending = path
            .extension()
            .and_then(|e| e.to_str())
            .unwrap_or("")
            .to_ascii_lowercase();
        match ending.as_str() {
            "csv" | "txt" | "tsv" | "dat" => Ok(Self::Csv),
            "bag" => Err(Problem::Ros1Bag.in_file(path)),
            "parquet" => Ok(Self::Parquet),
            "npz" => Ok(Self::Npz),
            "mat" => Ok(Self::Mat),
            "mcap" | "db3" => Ok(Self::Bag),
            _ => Err(Problem::UnknownFormat(ending).in_file(path)),
        }
    }
}

/// Reads a recording from memory; `name` stands in messages in place of a path.
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
        Format::Bag => bag::read(bag::Input::Bytes(bytes), name, options),
    }
}
