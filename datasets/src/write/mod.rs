//! Writers of CSV and Parquet. A file is written under a temporary name beside its place and then
//! renamed, so that nothing half-written is left behind.

mod csv;
mod parquet;

use crate::{Group, Recording};
use ndarray::Array2;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// A recording that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", file.display())]
pub struct WriteError {
    /// The file.
    pub file: PathBuf,
    /// What went wrong.
    pub problem: WriteProblem,
}

/// What went wrong while writing.
#[derive(Debug, thiserror::Error)]
pub enum WriteProblem {
    /// The ending is not that of a format that can be written.
    #[error("cannot be written as `{0}`; use .csv or .parquet")]
    UnknownFormat(String),
    /// The disk.
    #[error("cannot be written ({0})")]
    Io(#[from] std::io::Error),
    /// The encoder.
    #[error("cannot be encoded ({0})")]
    Encoder(String),
}

/// Writes a recording; the ending of the name (.csv or .parquet) decides on the format.
///
/// Numbers keep every bit (CSV: shortest text that reads back the same). Parquet also keeps
/// whether the torque was low-passed ([`Recording::torque_filter`]), which CSV cannot.
///
/// # Errors
/// An unknown ending or a failure of the disk; the file is then as it was before.
pub fn write(recording: &Recording, path: &Path) -> Result<(), WriteError> {
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
        "csv" => csv::encode(recording, out),
        _ => parquet::encode(recording, out),
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
    let mut temporary = tempfile::NamedTempFile::new_in(folder)?;
    let mut out = BufWriter::new(temporary.as_file_mut());
    encode(&mut out)?;
    std::io::Write::flush(&mut out)?;
    drop(out);
    temporary.persist(path).map_err(|e| e.error)?;
    Ok(())
}

/// The tables of a recording in the order in which they are written.
fn tables(recording: &Recording) -> Vec<(Group, &Array2<f64>)> {
    let of = |group| match group {
        Group::Q => Some(&recording.q),
        Group::Ql => recording.ql.as_ref(),
        Group::Qd => recording.qd.as_ref(),
        Group::Qdd => recording.qdd.as_ref(),
        Group::Tau => recording.tau.as_ref(),
        Group::QRef => recording.q_ref.as_ref(),
        Group::QdRef => recording.qd_ref.as_ref(),
        Group::Temp => recording.temp.as_ref(),
    };
    Group::ALL
        .into_iter()
        .filter_map(|g| Some((g, of(g)?)))
        .collect()
}

/// Names of the columns, trajectory and time first.
fn header(recording: &Recording) -> Vec<String> {
    let joints = tables(recording).into_iter().flat_map(|(group, table)| {
        (1..=table.ncols()).map(move |j| format!("{}{j}", group.name()))
    });
    ["trajectory".to_owned(), "time".to_owned()]
        .into_iter()
        .chain(joints)
        .collect()
}
