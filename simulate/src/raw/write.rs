//! Raw recordings as files.

use super::RawCase;
use crate::SimulateError;
use crate::cases::write_whole;
use std::fs;
use std::path::Path;

/// Writes `cases/ID/{robot.urdf,train.csv,test.csv}` and `truth/ID.json` into `folder`.
///
/// # Errors
/// A file cannot be written; what is there is then whole, but the case is not complete.
pub fn write(case: &RawCase, folder: &Path) -> Result<(), SimulateError> {
    let open = folder.join("cases").join(&case.id);
    let sealed = folder.join("truth");
    for path in [&open, &sealed] {
        fs::create_dir_all(path).map_err(|source| SimulateError::Write {
            path: path.clone(),
            source,
        })?;
    }
    datasets::write(&case.train, &open.join("train.csv"))?;
    datasets::write(&case.test, &open.join("test.csv"))?;
    write_whole(&open.join("robot.urdf"), &case.urdf)?;
    let path = sealed.join(format!("{}.json", case.id));
    let text = serde_json::to_string_pretty(&case.truth).map_err(|source| SimulateError::Json {
        path: path.clone(),
        source,
    })?;
    write_whole(&path, &text)
}
