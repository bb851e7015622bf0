//! MJCF, the format of MuJoCo.
//!
//! Files and includes (`source`), defaults (`attributes`) and settings (`settings`) make a scene of bodies and joints (`scene`,
//! `shapes`); of its joints some are chosen (`choice`, `couplings`) and make the robot (`chain`). New numbers go into the
//! same files (`write`). Actuators drive the chosen joints (`actuators`, `law`) and take new gains (`drives`).

mod actuators;
mod apparent;
mod attributes;
mod chain;
mod choice;
mod couplings;
mod drives;
mod edit;
mod law;
mod pose;
mod refusal;
mod scene;
mod settings;
mod shapes;
mod source;
mod write;

pub use actuators::Actuator;
pub use drives::DriveEdit;
pub use edit::Edited;
pub use law::ActuatorKind;

use crate::robot::{Robot, RobotError};
use attributes::Classes;
use chain::Chain;
use refusal::refused;
use scene::Scene;
use source::Sources;
use std::path::Path;

/// A model in MJCF with the joints that make the robot.
#[derive(Clone, Debug)]
pub struct Mjcf {
    sources: Sources,
    joints: Vec<String>,
}

impl Mjcf {
    /// Reads a file with all that it includes. `joints` names the joints of the robot, base first; empty for the one
    /// actuated chain.
    ///
    /// # Errors
    /// A file that cannot be read or parsed, or an `<include>` that cannot be followed.
    pub fn from_file(path: &Path, joints: &[String]) -> Result<Self, RobotError> {
        Ok(Self {
            sources: Sources::read(path)?,
            joints: joints.to_vec(),
        })
    }

    /// The same of a text, which cannot include anything.
    ///
    /// # Errors
    /// As [`Mjcf::from_file`].
    pub fn from_text(text: &str, joints: &[String]) -> Result<Self, RobotError> {
        Ok(Self {
            sources: Sources::of_text(text)?,
            joints: joints.to_vec(),
        })
    }

    /// The robot: a chain of hinge and slide joints from the world outwards, in the world's frame, with gravity, springs and
    /// gravity compensation. Everything that no chosen joint moves against each other is merged, other joints are fixed
    /// at their reference; [`Robot::notes`] says which, and what else the robot does not hold.
    ///
    /// # Errors
    /// No MJCF, no one chain, elements that are not supported on what the chosen joints carry, or an inertia that no
    /// mechanism can have.
    pub fn robot(&self) -> Result<Robot, RobotError> {
        self.with_chain(|scene, chain| chain.robot(scene))
    }

    /// The model's files with the numbers of `robot`: inertias, damping, dry friction, armature and gravity where they differ,
    /// everything else untouched to the byte. `zeros` (rad or m, one per joint or none) move the joints' zeros:
    /// q_true = q + zero.
    ///
    /// A link's inertia is written to the body that its joint moves, less what the bodies fixed to it have; where that is no
    /// possible body, they become lighter.
    ///
    /// # Errors
    /// As [`Mjcf::robot`], or a robot with other joints.
    pub fn with(&self, robot: &Robot, zeros: &[f64]) -> Result<Edited, RobotError> {
        let changes = self.with_chain(|scene, chain| write::changes(scene, chain, robot, zeros))?;
        Ok(Edited::new(self.sources.clone(), changes))
    }

    /// The same with other drives, one per joint: gains and force ranges are set at the actuators themselves, their default classes
    /// stay as they are. A damping ratio becomes the kv that it stands for, and dry friction holds a joint without creep
    /// (`solreffriction`, `solimpfriction`).
    ///
    /// # Errors
    /// As [`Mjcf::with`], another number of drives, or two actuators at one joint.
    pub fn with_drives(
        &self,
        robot: &Robot,
        zeros: &[f64],
        drives: &[DriveEdit],
    ) -> Result<Edited, RobotError> {
        let changes = self.with_chain(|scene, chain| {
            let mut changes = write::changes(scene, chain, robot, zeros)?;
            drives::changes(scene, chain, drives, &mut changes)?;
            drives::holding_friction(scene, chain, robot, &mut changes);
            Ok(changes)
        })?;
        Ok(Edited::new(self.sources.clone(), changes))
    }

    /// The actuator of each joint of the robot; none where nothing drives it.
    ///
    /// Damping and armature that an actuator adds to its joint are the joint's, see [`Mjcf::robot`].
    ///
    /// # Errors
    /// As [`Mjcf::robot`], or two actuators at one joint.
    pub fn actuators(&self) -> Result<Vec<Option<Actuator>>, RobotError> {
        let found = self.with_chain(|scene, chain| {
            let found = actuators::read(scene, chain)?;
            Ok(found
                .into_iter()
                .map(|one| one.map(|f| f.actuator))
                .collect())
        })?;
        Ok(found)
    }

    fn with_chain<T>(
        &self,
        then: impl FnOnce(&Scene<'_, '_, '_>, &Chain) -> Result<T, RobotError>,
    ) -> Result<T, RobotError> {
        let documents = self.sources.documents()?;
        let root = documents.root();
        if root.tag() != "mujoco" {
            return Err(refused(format!(
                "its outermost element is <{}>, not <mujoco>; give the file that includes this one",
                root.tag()
            )));
        }
        let classes = Classes::read(root)?;
        let scene = Scene::read(root, &classes)?;
        let chain = Chain::of(&scene, &self.joints)?;
        then(&scene, &chain)
    }
}
