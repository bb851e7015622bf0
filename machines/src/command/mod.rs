//! The commands, one file each.

pub mod eval;
pub mod identify;
pub mod list;
pub mod payload;
pub mod simulate;

use machines::MachineError;
use machines::plant::Carried;
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

/// Reads `MASS` or `MASS,INERTIA`, neither negative.
fn body(text: &str) -> Result<Carried, String> {
    let wrong = || "expected MASS or MASS,INERTIA in kg and kg·m², for example 2.5,0.01".to_owned();
    let numbers: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse().map_err(|_| wrong()))
        .collect::<Result<_, _>>()?;
    match numbers[..] {
        [mass] if mass >= 0.0 && mass.is_finite() => Ok(Carried { mass, inertia: 0.0 }),
        [mass, inertia]
            if mass >= 0.0 && inertia >= 0.0 && mass.is_finite() && inertia.is_finite() =>
        {
            Ok(Carried { mass, inertia })
        }
        _ => Err(wrong()),
    }
}
