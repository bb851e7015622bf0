//! Robot formats: readers and writers of descriptions.
//!
//! A format is one folder with reading, writing and new numbers in an existing text; the result of reading is
//! always a [`Robot`]. The format of a file follows from its outermost element.

mod changed;
mod choice;
mod mjcf;
mod share;
mod urdf;
mod xml;

pub use changed::{Changed, Load};
pub use mjcf::{Actuator, ActuatorKind, DriveEdit, Edited, Mjcf};
pub use urdf::{Urdf, to_urdf, urdf_with};

use super::{Builtin, Robot, RobotError};
use std::path::Path;

/// Built-in machines that have no description by links (crate `machines`): named so that asking for one as a robot ends with
/// the command that takes it.
pub const MACHINES: [&str; 5] = ["rotary_axis", "linear_axis", "scara4", "delta3", "delta4"];

/// Description of a robot as the user has it, into which new numbers can be written.
#[derive(Clone, Debug)]
pub enum Description {
    /// Text of a URDF.
    Urdf(Urdf),
    /// Files of an MJCF model.
    Mjcf(Mjcf),
}

/// The joints of a description, and the chains that they make.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chains {
    /// Names of all joints that turn or slide, every one after those that carry it.
    pub joints: Vec<String>,
    /// Chains that may be meant, each base first: to every end, and to where each spreads.
    pub chains: Vec<Vec<String>>,
}

impl Chains {
    fn of(tree: &choice::Tree<'_>) -> Self {
        let scalar = tree.joints.iter().filter(|j| j.scalar);
        Self {
            joints: scalar.map(|j| j.name.to_owned()).collect(),
            chains: tree.chains(),
        }
    }

    /// Chains of joints in a file; empty for a built-in robot.
    ///
    /// # Errors
    /// The file cannot be read, or is not a description.
    pub fn load(name_or_path: &str) -> Result<Self, RobotError> {
        let path = Path::new(name_or_path);
        if Robot::builtin(name_or_path).is_some() {
            return Ok(Self::default());
        }
        let text = std::fs::read_to_string(path).map_err(|source| RobotError::Read {
            path: path.to_owned(),
            source,
        })?;
        let chains = if is_mjcf(&text) {
            Mjcf::from_file(path, &[]).and_then(|m| m.chains())
        } else {
            Urdf::new(text, &[]).and_then(|u| u.chains())
        };
        chains.map_err(|e| in_file(path, e))
    }
}

impl Description {
    /// Reads a file. `joints` names the joints of the robot, base first, or a frame at the end of its chain,
    /// where the description holds more; empty for its only chain. `NAME=POSITION` (rad or m) holds another
    /// joint at that position.
    ///
    /// # Errors
    /// The file cannot be read or is refused.
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
            let urdf = Urdf::new(text, joints)?;
            let robot = urdf.robot()?;
            Ok((Self::Urdf(urdf), robot))
        };
        read().map_err(|error| in_file(path, error))
    }

    /// The joints of the description, and the chains that they make.
    ///
    /// # Errors
    /// None of a description that has been read.
    pub fn chains(&self) -> Result<Chains, RobotError> {
        match self {
            Self::Urdf(urdf) => urdf.chains(),
            Self::Mjcf(mjcf) => mjcf.chains(),
        }
    }
}

/// An error with the file in which it is.
fn in_file(path: &Path, error: RobotError) -> RobotError {
    let source = match error {
        RobotError::Read { path: own, source } if own == path => {
            return RobotError::Read { path: own, source };
        }
        RobotError::Xacro { .. } => RobotError::Xacro {
            file: path.file_name().map(|n| n.to_string_lossy().into_owned()),
        },
        other => other,
    };
    RobotError::InFile {
        path: path.to_owned(),
        source: Box::new(source),
    }
}

/// Whether a text is meant as an MJCF: by its outermost element, or by its content where it cannot be parsed.
fn is_mjcf(text: &str) -> bool {
    match xml::parse(&xml::readable(text)) {
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
                    reason: format!(
                        "{name_or_path} is built in and one chain as it stands; leave --joints out"
                    ),
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
        Self::from_urdf_str(&text).map_err(|error| in_file(path, error))
    }

    /// Reads a URDF with a single chain: see [`Urdf::robot`].
    ///
    /// # Errors
    /// Not a URDF, not one serial chain, or an inertia that no mechanism can have.
    pub fn from_urdf_str(text: &str) -> Result<Self, RobotError> {
        Urdf::new(text, &[])?.robot()
    }
}
