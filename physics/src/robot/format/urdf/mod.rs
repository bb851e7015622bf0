//! Reader and writer of URDF.
//!
//! Links and joints (`elements`) make a tree (`tree`), of which the chosen joints make the robot (`read`); new numbers go into the same
//! text (`write`).

mod elements;
mod read;
mod tree;
mod write;

pub use write::to_urdf;

use super::Changed;
use super::choice::Wanted;
use super::xml::{parse, readable};
use crate::robot::{Robot, RobotError};
use read::Model;

/// A URDF with the joints that make the robot.
#[derive(Clone, Debug)]
pub struct Urdf {
    text: String,
    wanted: Wanted,
}

impl Urdf {
    /// Description from a text. `joints` names the joints of the robot, base first, or a frame at the end of its chain;
    /// empty for the only chain. `NAME=POSITION` (rad or m) holds a joint that is not the robot's at that
    /// position.
    ///
    /// # Errors
    /// A position that is not a number.
    pub fn new(text: impl Into<String>, joints: &[String]) -> Result<Self, RobotError> {
        Ok(Self {
            text: text.into(),
            wanted: Wanted::read(joints)?,
        })
    }

    /// Text of the description, as given.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The robot. Fixed joints are merged with the inertia that they carry, and so are the joints that were not
    /// chosen, at their reference; [`Robot::notes`] lists them.
    ///
    /// # Errors
    /// Not a URDF, not one serial chain, or an inertia that no mechanism can have.
    pub fn robot(&self) -> Result<Robot, RobotError> {
        let text = readable(&self.text);
        let document = parse(&text)?;
        Model::read(&document, &self.wanted)?.robot()
    }

    /// Text with the numbers of a changed robot, everything else untouched to the byte.
    ///
    /// A link's inertia is written to the link that its joint moves, less the inertias of the links fixed to
    /// it. Where no body can have that difference, those become lighter. A payload becomes a link of its own.
    ///
    /// # Errors
    /// As [`Urdf::robot`], or a robot with other joints.
    pub fn with(&self, changed: &Changed<'_>) -> Result<String, RobotError> {
        let text = readable(&self.text);
        let document = parse(&text)?;
        let model = Model::read(&document, &self.wanted)?;
        write::changed(&self.text, &document, &model, changed)
    }

    /// The robot of a changed text of this description.
    ///
    /// # Errors
    /// As [`Urdf::robot`].
    pub fn reread(&self, text: &str) -> Result<Robot, RobotError> {
        let text = text.to_owned();
        let wanted = self.wanted.clone();
        Self { text, wanted }.robot()
    }

    /// Names of all joints that turn or slide, every one after those that carry it, and the chains that may be meant.
    ///
    /// # Errors
    /// Not a URDF.
    pub(super) fn chains(&self) -> Result<super::Chains, RobotError> {
        let text = readable(&self.text);
        let document = parse(&text)?;
        Ok(super::Chains::of(&Model::tree(&document)?.candidates()))
    }
}

/// Text of `urdf` with the inertias, damping and friction of `robot`, everything else untouched to the byte:
/// [`Urdf::with`] for the joints of `robot`.
///
/// # Errors
/// `urdf` is not a URDF, or not that of this robot's joints.
pub fn urdf_with(urdf: &str, robot: &Robot) -> Result<String, RobotError> {
    let all = Urdf::new(urdf, &[])?.chains()?;
    if let Some(name) = robot
        .joint_names()
        .into_iter()
        .find(|n| !all.joints.contains(n))
    {
        return Err(RobotError::Mismatch {
            what: "joint",
            name,
        });
    }
    Urdf::new(urdf, &robot.joint_names())?.with(&Changed::of(robot))
}
