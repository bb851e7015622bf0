//! Cases as files.

use super::case::Case;
use super::generate::generate_with;
use super::kind::CaseSpec;
use super::sensors::Sensors;
use crate::SimulateError;
use datasets::Recording;
use rayon::prelude::*;
use serde::Serialize;
use std::fs;
use std::path::Path;

/// Writes `cases/ID/{robot.urdf,train.parquet,test.parquet}` and `truth/ID.json` into `folder`.
///
/// # Errors
/// A file cannot be written; what is there is then whole, but the case is not complete.
pub fn write(case: &Case, folder: &Path) -> Result<(), SimulateError> {
    let recordings = [("train.parquet", &case.train), ("test.parquet", &case.test)];
    write_sealed(folder, &case.id, &case.urdf, &recordings, &case.truth)
}

/// Writes the open part of a case into `cases/ID/` and its truth into `truth/ID.json` of `folder`.
///
/// # Errors
/// As [`write()`].
pub(crate) fn write_sealed(
    folder: &Path,
    id: &str,
    urdf: &str,
    recordings: &[(&str, &Recording)],
    truth: &impl Serialize,
) -> Result<(), SimulateError> {
    let open = folder.join("cases").join(id);
    let sealed = folder.join("truth");
    for path in [&open, &sealed] {
        fs::create_dir_all(path).map_err(|source| SimulateError::Write {
            path: path.clone(),
            source,
        })?;
    }
    for (name, recording) in recordings {
        datasets::write(recording, &open.join(name))?;
    }
    write_whole(&open.join("robot.urdf"), urdf)?;
    let path = sealed.join(format!("{id}.json"));
    let text = serde_json::to_string_pretty(truth).map_err(|source| SimulateError::Json {
        path: path.clone(),
        source,
    })?;
    write_whole(&path, &text)
}

/// Generates cases of a run with some further sensors and writes them, on the threads of the current pool.
/// `done` is called with the name and kind of each case that is written.
///
/// # Errors
/// The first case that could not be made or written.
pub fn write_all(
    cases: &[CaseSpec],
    seed: u64,
    sensors: Sensors,
    folder: &Path,
    done: impl Fn(&str, &str) + Sync,
) -> Result<(), SimulateError> {
    cases.par_iter().try_for_each(|spec| {
        let case = generate_with(spec, seed, sensors)?;
        write(&case, folder)?;
        done(&case.id, &case.truth.kind);
        Ok(())
    })
}

/// Writes a text under a temporary name first.
pub(crate) fn write_whole(path: &Path, text: &str) -> Result<(), SimulateError> {
    report::write_atomic(path, text).map_err(|error| SimulateError::Write {
        path: error.path,
        source: error.source,
    })
}
