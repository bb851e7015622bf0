//! Robot formats: what a description is read from and written to.
//!
//! A format is one folder with reading, writing and new numbers in an existing text; what is read is always a [`Robot`].

mod urdf;

pub use urdf::{to_urdf, urdf_with};

use super::{Builtin, Robot, RobotError};
use std::path::Path;

/// Built-in machines that have no description by links (crate `machines`): named so that asking for one as a robot ends with
/// the command that takes it.
pub const MACHINES: [&str; 5] = ["rotary_axis", "linear_axis", "scara4", "delta3", "delta4"];

impl Robot {
    /// A built-in robot by name, or else a URDF by path.
    ///
    /// # Errors
    /// Neither exists, or the URDF is refused.
    pub fn load(name_or_path: &str) -> Result<Self, RobotError> {
        if let Some(robot) = Self::builtin(name_or_path) {
            return Ok(robot);
        }
        let path = Path::new(name_or_path);
        if !path.exists() && MACHINES.contains(&name_or_path) {
            return Err(RobotError::Machine {
                name: name_or_path.to_owned(),
            });
        }
        if !path.exists() && path.extension().is_none() {
            return Err(RobotError::UnknownRobot {
                name: name_or_path.to_owned(),
                builtins: Builtin::ALL.map(Builtin::name).join(", "),
            });
        }
        Self::from_urdf_file(path)
    }

    /// Reads a URDF file. See [`Robot::from_urdf_str`].
    ///
    /// # Errors
    /// The file cannot be read, or is refused.
    pub fn from_urdf_file(path: impl AsRef<Path>) -> Result<Self, RobotError> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|source| RobotError::Read {
            path: path.to_owned(),
            source,
        })?;
        Self::from_urdf_str(&text).map_err(|source| RobotError::InFile {
            path: path.to_owned(),
            source: Box::new(source),
        })
    }

    /// Reads a URDF. Fixed joints are merged with the inertia that they carry; the moving joints
    /// (revolute, continuous, prismatic) must form one serial chain.
    ///
    /// # Errors
    /// Not a URDF, not one serial chain, or an inertia that no mechanism can have.
    pub fn from_urdf_str(text: &str) -> Result<Self, RobotError> {
        urdf::read(text)
    }
}
