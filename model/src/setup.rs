//! From the command line's robot and drive file to a robot and the way its recordings are read.

use datasets::{
    Affine, ColumnMap, Group, Part, ReadError, ReadOptions, Recording, TorqueFilter, read,
};
use nalgebra::Vector3;
use physics::robot::{
    Robot, RobotError,
    drive::{Conversion, Drive},
};
use std::path::{Path, PathBuf};

/// A robot with everything that reading its recordings needs.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The robot, drive data included.
    pub robot: Robot,
    /// Drive file, if one was given.
    pub drive: Option<Drive>,
}

/// A robot or a recording that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// The robot or its drive file.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// A recording.
    #[error(transparent)]
    Read(#[from] ReadError),
}

/// Reads gravity in the base frame, m/s², from `X,Y,Z`.
///
/// # Errors
/// Not three finite numbers.
pub fn gravity(text: &str) -> Result<[f64; 3], String> {
    let parts: Vec<f64> = text
        .split(',')
        .filter_map(|part| part.trim().parse().ok())
        .filter(|value: &f64| value.is_finite())
        .collect();
    match (<[f64; 3]>::try_from(parts), text.matches(',').count()) {
        (Ok(gravity), 2) => Ok(gravity),
        _ => Err("expected three numbers in m/s², for example 0,0,-9.81".into()),
    }
}

impl Setup {
    /// Loads a robot by the name of a built-in or the path of a URDF.
    ///
    /// # Errors
    /// No such robot, or a description or drive file that cannot be used.
    pub fn new(
        robot: &str,
        drive: Option<&Path>,
        gravity: Option<[f64; 3]>,
    ) -> Result<Self, SetupError> {
        let mut robot = Robot::load(robot)?;
        if let Some(g) = gravity {
            robot = robot.with_gravity(Vector3::from(g));
        }
        Self::of(robot, drive)
    }

    /// For a robot that is loaded already.
    ///
    /// # Errors
    /// A drive file that cannot be used.
    pub fn of(robot: Robot, drive: Option<&Path>) -> Result<Self, SetupError> {
        let drive = drive
            .map(|path| Drive::from_file(path, &robot))
            .transpose()?;
        let robot = match &drive {
            Some(drive) => drive.apply(robot)?,
            None => robot,
        };
        Ok(Self { robot, drive })
    }

    /// Options for reading this robot's recordings.
    ///
    /// # Errors
    /// A drive file that cannot convert torque.
    pub fn read_options(&self, part: Part, torque_needed: bool) -> Result<ReadOptions, SetupError> {
        let mut options = if self.robot.name() == "kr300" {
            ReadOptions::kr300(part)
        } else {
            ReadOptions {
                part,
                ..ReadOptions::for_robot(self.robot.dof())
            }
        };
        options.torque_needed = torque_needed;
        if let Some(drive) = &self.drive {
            options.columns = column_map(drive, &self.robot)?;
            if let Some(f) = drive.torque_filter {
                options.torque_filter = Some(TorqueFilter {
                    order: f.order,
                    cutoff_hz: f.cutoff_hz,
                    ripple_db: f.ripple_db,
                });
            }
        }
        Ok(options)
    }

    /// Reads recordings of this robot.
    ///
    /// # Errors
    /// The first recording that cannot be used.
    pub fn read(
        &self,
        paths: &[PathBuf],
        part: Part,
        torque_needed: bool,
    ) -> Result<Vec<Recording>, SetupError> {
        let options = self.read_options(part, torque_needed)?;
        paths.iter().map(|path| Ok(read(path, &options)?)).collect()
    }
}

fn column_map(drive: &Drive, robot: &Robot) -> Result<ColumnMap, SetupError> {
    let affine = |list: Vec<Conversion>| -> Vec<Affine> {
        list.into_iter()
            .map(|c| Affine {
                scale: c.scale,
                offset: c.offset,
            })
            .collect()
    };
    let position = affine(drive.position_conversion(robot));
    let rate = affine(drive.rate_conversion(robot));
    let torque = affine(drive.torque_conversion(robot)?);
    let units = [
        (Group::Q, &position),
        (Group::Ql, &position),
        (Group::QRef, &position),
        (Group::Qd, &rate),
        (Group::Qdd, &rate),
        (Group::QdRef, &rate),
        (Group::Tau, &torque),
    ];
    Ok(ColumnMap {
        names: drive.columns.clone(),
        units: units
            .into_iter()
            .map(|(group, list)| (group, list.clone()))
            .collect(),
        time_scale: Some(drive.time_scale()),
    })
}

#[cfg(test)]
mod tests {
    use super::gravity;

    #[test]
    fn gravity_from_text() {
        assert_eq!(gravity("0,0,-9.81"), Ok([0.0, 0.0, -9.81]));
        assert_eq!(gravity("-1, 0.5, 0"), Ok([-1.0, 0.5, 0.0]));
        for wrong in ["0,0", "0,0,0,0", "0,0,x", "0,0,inf", "1,,2,3", ""] {
            assert!(gravity(wrong).is_err(), "{wrong}");
        }
    }
}
