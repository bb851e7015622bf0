//! Robot formats: what a description is read from and written to.
//!
//! A format is one folder with reading, writing and new numbers in an existing text; what is read is always a [`Robot`]. Which
//! format a file has follows from its outermost element.

mod mjcf;
mod urdf;

pub use mjcf::{Actuator, ActuatorKind, DriveEdit, Edited, Mjcf};
pub use urdf::{to_urdf, urdf_with};

use super::{Builtin, Robot, RobotError};
use roxmltree::Document;
use std::path::Path;

/// Built-in machines that have no description by links (crate `machines`): named so that asking for one as a robot ends with
/// the command that takes it.
pub const MACHINES: [&str; 5] = ["rotary_axis", "linear_axis", "scara4", "delta3", "delta4"];

/// A robot's description as the user has it: what new numbers can be written into.
#[derive(Clone, Debug)]
pub enum Description {
    /// Text of a URDF.
    Urdf(String),
    /// Files of an MJCF.
    Mjcf(Mjcf),
}

impl Description {
    /// Reads a file. `joints` names the joints of the robot, base first, where an MJCF holds more; empty for its one
    /// actuated chain.
    ///
    /// # Errors
    /// The file cannot be read or is refused, or joints are chosen from a URDF.
    pub fn load(path: &Path, joints: &[String]) -> Result<(Self, Robot), RobotError> {
        let read = || -> Result<(Self, Robot), RobotError> {
            let text = std::fs::read_to_string(path).map_err(|source| RobotError::Read {
                path: path.to_owned(),
                source,
            })?;
            if is_mjcf(&text) {
                let mjcf = Mjcf::from_file(path, joints)?;
                let robot = mjcf.robot()?;
                return Ok((Self::Mjcf(mjcf), robot));
            }
            if !joints.is_empty() {
                return Err(RobotError::Joints {
                    name: path.display().to_string(),
                });
            }
            let robot = Robot::from_urdf_str(&text)?;
            Ok((Self::Urdf(text), robot))
        };
        read().map_err(|error| match error {
            RobotError::Read { path: own, source } if own == path => {
                RobotError::Read { path: own, source }
            }
            error @ RobotError::Joints { .. } => error,
            source => RobotError::InFile {
                path: path.to_owned(),
                source: Box::new(source),
            },
        })
    }
}

/// Whether a text is meant as an MJCF: by its outermost element, or by what it holds where it cannot be parsed.
fn is_mjcf(text: &str) -> bool {
    match Document::parse(text) {
        Ok(document) => document
            .root_element()
            .tag_name()
            .name()
            .starts_with("mujoco"),
        Err(_) => text.contains("<mujoco"),
    }
}

impl Robot {
    /// A built-in robot by name, or else a URDF or MJCF by path, with its description where it has one. For `joints` see
    /// [`Description::load`].
    ///
    /// # Errors
    /// Neither exists, or the file is refused.
    pub fn load(
        name_or_path: &str,
        joints: &[String],
    ) -> Result<(Self, Option<Description>), RobotError> {
        if let Some(robot) = Self::builtin(name_or_path) {
            return if joints.is_empty() {
                Ok((robot, None))
            } else {
                Err(RobotError::Joints {
                    name: name_or_path.to_owned(),
                })
            };
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
        let (description, robot) = Description::load(path, joints)?;
        Ok((robot, Some(description)))
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
