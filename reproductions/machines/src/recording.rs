//! Recordings of a machine: columns, units and drives.

use crate::MachineError;
use crate::description::Description;
use datasets::{Affine, ColumnMap, ReadOptions, Recording, TorqueFilter, read};
use physics::robot::drive::{Conversion, Drive};
use std::path::Path;

/// Reads the drive file of a machine.
///
/// # Errors
/// It cannot be read, or does not fit the axes.
pub fn drive(path: &Path, description: &Description) -> Result<Drive, MachineError> {
    Ok(Drive::from_file(path, description)?)
}

/// Reads a recording of a machine (columns as every recording of the project, docs/formats.md).
///
/// # Errors
/// It cannot be used, or the drive file cannot convert its torque.
pub fn recording(
    path: &Path,
    description: &Description,
    drive: Option<&Drive>,
    torque_needed: bool,
) -> Result<Recording, MachineError> {
    let mut options = ReadOptions {
        torque_needed,
        joints: description.axis.iter().map(|a| a.name.clone()).collect(),
        ..ReadOptions::for_robot(description.axis.len())
    };
    if let Some(drive) = drive {
        let affine = |list: Vec<Conversion>| -> Vec<Affine> {
            let affine = |c: Conversion| Affine {
                scale: c.scale,
                offset: c.offset,
            };
            list.into_iter().map(affine).collect()
        };
        options.columns = ColumnMap::of_drive(
            drive.columns.clone(),
            affine(drive.position_conversion(description)),
            affine(drive.rate_conversion(description)),
            affine(drive.torque_conversion(description)?),
            drive.time_scale(),
        );
        options.torque_filter = drive.torque_filter.map(|f| {
            TorqueFilter {
                order: f.order,
                cutoff_hz: f.cutoff_hz,
                ripple_db: f.ripple_db,
                recognised: false,
            }
            .always()
        });
    }
    Ok(read(path, &options)?)
}
