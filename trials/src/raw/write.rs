//! Raw recordings as files.

use super::RawCase;
use crate::SimulateError;
use crate::cases::write_sealed;
use std::path::Path;

/// Writes `cases/ID/{robot.urdf,train.csv,test.csv}` and `truth/ID.json` into `folder`.
///
/// # Errors
/// A file cannot be written; what is there is then whole, but the case is not complete.
pub fn write(case: &RawCase, folder: &Path) -> Result<(), SimulateError> {
    let recordings = [("train.csv", &case.train), ("test.csv", &case.test)];
    write_sealed(folder, &case.id, &case.urdf, &recordings, &case.truth)
}
