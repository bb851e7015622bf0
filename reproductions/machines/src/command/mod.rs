//! The commands, one file each.

pub mod eval;
pub mod identify;
pub mod list;
pub mod payload;
pub mod simulate;

use crate::plant::Carried;
use crate::store::MachineFile;
use crate::{MachineError, recording};
use datasets::Recording;
use std::path::{Path, PathBuf};

/// An identified machine and a recording of it.
#[derive(Debug, clap::Args)]
struct Given {
    /// Folder that machine identify has written.
    #[arg(long)]
    model: PathBuf,
    /// Recording (.csv, .parquet, .npz).
    #[arg(long)]
    data: PathBuf,
    /// Drive file: names and units of columns, torque factors.
    #[arg(long)]
    drive: Option<PathBuf>,
}

impl Given {
    /// Reads both; whether the recording needs torque.
    fn read(&self, torque: bool) -> Result<(MachineFile, Recording), MachineError> {
        let file = MachineFile::load(&self.model)?;
        let drive = self
            .drive
            .as_deref()
            .map(|path| recording::drive(path, &file.machine))
            .transpose()?;
        let data = recording::recording(&self.data, &file.machine, drive.as_ref(), torque)?;
        Ok((file, data))
    }
}

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
