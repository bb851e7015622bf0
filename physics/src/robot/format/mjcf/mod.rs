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
mod models;
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

use super::choice::Wanted;
use super::{Chains, Changed};
use crate::robot::{Robot, RobotError};
use chain::Chain;
use couplings::Couplings;
use models::Models;
use refusal::refused;
use scene::Scene;
use source::Sources;
use std::path::Path;

/// A model in MJCF with the joints that make the robot.
#[derive(Clone, Debug)]
pub struct Mjcf {
    sources: Sources,
    wanted: Wanted,
}

impl Mjcf {
    /// Reads a file with all that it includes. `joints` names the joints of the robot, base first; empty for
    /// the only actuated chain.
    ///
    /// # Errors
    /// A file that cannot be read or parsed, or an `<include>` that cannot be followed.
    pub fn from_file(path: &Path, joints: &[String]) -> Result<Self, RobotError> {
        Ok(Self {
            sources: Sources::read(path)?,
            wanted: Wanted::read(joints)?,
        })
    }

    /// Reads a text, which cannot include anything; `joints` as in [`Self::from_file`].
    ///
    /// # Errors
    /// As [`Mjcf::from_file`].
    pub fn from_text(text: &str, joints: &[String]) -> Result<Self, RobotError> {
        Ok(Self {
            sources: Sources::of_text(text)?,
            wanted: Wanted::read(joints)?,
        })
    }

    /// The robot: a chain of hinge and slide joints from the world outwards, in the world's frame, with
    /// gravity, springs and gravity compensation. Bodies that no chosen joint moves against each other are
    /// merged, other joints are fixed at their reference. [`Robot::notes`] lists these joints, and all else
    /// that the robot does not hold.
    ///
    /// # Errors
    /// No MJCF, no one chain, elements that are not supported on what the chosen joints carry, or an inertia that no
    /// mechanism can have.
    pub fn robot(&self) -> Result<Robot, RobotError> {
        self.with_chain(|scene, chain| chain.robot(scene))
    }

    /// Files of the model with the numbers of a changed robot: inertias, damping, dry friction, armature and
    /// gravity where they differ, everything else untouched to the byte.
    ///
    /// A link's inertia is written to the body that its joint moves, less the inertias of the bodies fixed to
    /// it. Where no body can have that difference, those become lighter. A payload becomes a body of its own.
    ///
    /// # Errors
    /// As [`Mjcf::robot`], or a robot with other joints.
    pub fn with(&self, changed: &Changed<'_>) -> Result<Edited, RobotError> {
        let changes = self.with_chain(|scene, chain| write::changes(scene, chain, changed))?;
        Ok(Edited::new(self.sources.clone(), changes))
    }

    /// Files of the model with the numbers of a changed robot and with other drives, one per joint. Gains and
    /// force ranges are set at the actuators themselves, their default classes stay as they are. A damping
    /// ratio becomes the kv that follows from it, and dry friction holds a joint without creep
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
        let changed = Changed {
            zeros,
            ..Changed::of(robot)
        };
        let changes = self.with_chain(|scene, chain| {
            let mut changes = write::changes(scene, chain, &changed)?;
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

    /// The robot of the changed files.
    ///
    /// # Errors
    /// As [`Mjcf::robot`].
    pub fn reread(&self, edited: &Edited) -> Result<Robot, RobotError> {
        let (sources, wanted) = (edited.sources()?, self.wanted.clone());
        Self { sources, wanted }.robot()
    }

    /// Names of all joints that turn or slide, and the chains that may be meant.
    ///
    /// # Errors
    /// No MJCF.
    pub(super) fn chains(&self) -> Result<Chains, RobotError> {
        self.with_scene(|scene| {
            let couplings = Couplings::read(scene)?;
            Ok(Chains::of(&choice::tree(scene, &couplings)))
        })
    }

    fn with_chain<T>(
        &self,
        then: impl FnOnce(&Scene<'_, '_, '_>, &Chain) -> Result<T, RobotError>,
    ) -> Result<T, RobotError> {
        self.with_scene(|scene| then(scene, &Chain::of(scene, &self.wanted)?))
    }

    fn with_scene<T>(
        &self,
        then: impl FnOnce(&Scene<'_, '_, '_>) -> Result<T, RobotError>,
    ) -> Result<T, RobotError> {
        let documents = self.sources.documents()?;
        let root = documents.root();
        if root.tag() != "mujoco" {
            return Err(refused(format!(
                "its outermost element is <{}>, not <mujoco>; give the file that includes this one",
                root.tag()
            )));
        }
        let models = Models::read(root)?;
        then(&Scene::read(&models)?)
    }
}
