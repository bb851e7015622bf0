//! The commands, one file each.

pub mod eval;
pub mod identify;
pub mod list;
pub mod simulate;

use machines::MachineError;
use std::path::Path;

/// Makes a folder and those above it.
fn folder(path: &Path) -> Result<(), MachineError> {
    std::fs::create_dir_all(path).map_err(|source| MachineError::Folder {
        path: path.to_owned(),
        source,
    })
}

/// Reads `AXIS=VALUE`, the axis from 1; gives it from 0.
fn of_axis(text: &str) -> Result<(usize, f64), String> {
    let wrong = || "expected AXIS=VALUE, for example 2=0.5".to_owned();
    let (axis, value) = text.split_once('=').ok_or_else(wrong)?;
    let axis: usize = axis.trim().parse().map_err(|_| wrong())?;
    let value: f64 = value.trim().parse().map_err(|_| wrong())?;
    if axis == 0 || !value.is_finite() {
        return Err(wrong());
    }
    Ok((axis - 1, value))
}
