//! Writers of CSV, Parquet and MCAP. A file is written under a temporary name beside its place and then renamed, so
//! that no incomplete file stays.

mod columns;
mod csv;
mod curves;
mod mcap;
mod parquet;
mod problem;
mod trajectory;

pub use curves::{Curves, Group, curves_ending, write_curves};
pub use problem::WriteProblem;
pub use trajectory::write_trajectories;

use crate::{Recording, Trajectory};
use columns::Table;
use signal::Motion;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// A recording that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", file.display())]
pub struct WriteError {
    /// Path of the file that was to be written.
    pub file: PathBuf,
    /// Problem for which writing failed.
    pub problem: WriteProblem,
}

/// Writes a recording; the ending of the name (.csv or .parquet) decides on the format.
///
/// Numbers keep every bit (CSV: shortest text that reads back the same). Parquet also keeps
/// whether the torque was low-passed ([`Recording::torque_filter`]), which CSV cannot.
///
/// # Errors
/// An unknown ending or a failure of the disk; the file is then as it was before.
pub fn write(recording: &Recording, path: &Path) -> Result<(), WriteError> {
    write_table(&Table::of(recording), path)
}

/// Writes a motion that is to be run, a label for each of its segments: `q_ref1` …, `qd_ref1` …, `qdd_ref1` … in the units of
/// docs/formats.md. The format is that of [`write()`].
///
/// # Errors
/// As [`write()`].
///
/// # Panics
/// When there is not one label per segment.
pub fn write_reference(motion: &Motion, labels: &[String], path: &Path) -> Result<(), WriteError> {
    assert_eq!(labels.len(), motion.segments.len(), "a label per segment");
    let named = labels.iter().zip(&motion.segments);
    let trajectories: Vec<Trajectory> = named
        .map(|(label, range)| Trajectory {
            label: label.clone(),
            range: range.clone(),
        })
        .collect();
    let table = Table {
        trajectories: &trajectories,
        time: &motion.time,
        groups: vec![
            ("q_ref", &motion.q),
            ("qd_ref", &motion.qd),
            ("qdd_ref", &motion.qdd),
        ],
        torque_filter: None,
    };
    write_table(&table, path)
}

fn write_table(table: &Table, path: &Path) -> Result<(), WriteError> {
    let fail = |problem| WriteError {
        file: path.to_owned(),
        problem,
    };
    let ending = path
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or("")
        .to_ascii_lowercase();
    let encode = |out: &mut BufWriter<&mut File>| match ending.as_str() {
        "csv" => csv::encode(table, out),
        _ => parquet::encode(table, out),
    };
    if !["csv", "parquet"].contains(&ending.as_str()) {
        return Err(fail(WriteProblem::UnknownFormat(ending.clone())));
    }
    atomically(path, encode).map_err(fail)
}

/// Lets `encode` fill a temporary file in the folder of `path`, then renames it.
fn atomically(
    path: &Path,
    encode: impl FnOnce(&mut BufWriter<&mut File>) -> Result<(), WriteProblem>,
) -> Result<(), WriteProblem> {
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    // Temporary files are private by default; a recording is as readable as any other new file.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut temporary = builder.tempfile_in(folder)?;
    let mut out = BufWriter::new(temporary.as_file_mut());
    encode(&mut out)?;
    std::io::Write::flush(&mut out)?;
    drop(out);
    temporary.persist(path).map_err(|e| e.error)?;
    Ok(())
}
