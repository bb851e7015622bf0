//! Interface of every withheld effect.

use physics::robot::RobotError;
use plant::build::Build;
use serde_json::Value;
use std::fmt::Debug;

/// The drawn shape of an effect. Its size is set afterwards and has the unit that the effect's file states; joints count
/// from 0.
pub trait Withheld: Debug + Send + Sync {
    /// Adds the effect in this size to a plant.
    ///
    /// # Errors
    /// The altered bodies make no possible robot.
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError>;

    /// Description of the effect in this size on an arm with `dof` joints.
    fn describe(&self, size: f64, dof: usize) -> Description;

    /// Largest size that is still plausible.
    fn largest(&self) -> f64 {
        f64::INFINITY
    }

    /// A small size to start the search from.
    fn smallest(&self) -> f64 {
        0.1
    }

    /// Whether its torque is that of one mechanism alone, which the simulation records separately.
    fn is_self_contained(&self) -> bool {
        false
    }

    /// The yielding part, if it has one.
    fn yielding(&self) -> Option<&dyn Yielding> {
        None
    }

    /// Whether the effect acts through the plant's own vibration. Its torque is then noted below 20 Hz only, as above
    /// that it is the difference of two large torques.
    fn vibrates(&self) -> bool {
        self.yielding().is_some()
    }
}

/// A part of the robot that yields under torque.
pub trait Yielding {
    /// Place of the yielding part.
    fn place(&self) -> Place;

    /// Greatest stiffness, N·m/rad.
    fn stiffness(&self, size: f64) -> f64;

    /// Static deflection under a torque (N·m), rad. `usual` is the root mean square of the torque on that joint, N·m.
    fn deflection(&self, size: f64, torque: f64, usual: f64) -> f64;
}

/// Place at which a robot yields.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Gear of this joint, between its rotor and its link.
    Gear(usize),
    /// Mount below the whole arm, a hinge that then is the plant's first joint.
    Mount,
}

/// Description of an effect beside its figures.
pub struct Description {
    /// Name of the mechanism in the answers.
    pub mechanism: &'static str,
    /// Joints that the effect belongs to; none: the whole arm.
    pub joints: Option<Vec<usize>>,
    /// Parameters of the mechanism.
    pub parameters: Value,
    /// Names of effects that no recording can tell from the effect.
    pub indistinguishable: Vec<&'static str>,
}

impl Description {
    /// Description of an effect that belongs to these joints.
    pub fn of_joints(joints: &[usize], mechanism: &'static str, parameters: Value) -> Self {
        Self {
            joints: Some(joints.to_vec()),
            ..Self::of_arm(mechanism, parameters)
        }
    }

    /// Description of an effect that belongs to the whole arm.
    pub fn of_arm(mechanism: &'static str, parameters: Value) -> Self {
        Self {
            mechanism,
            joints: None,
            parameters,
            indistinguishable: Vec::new(),
        }
    }

    /// Adds `other` to the effects that no recording can tell from it, if `holds`.
    pub fn same_as(mut self, other: &'static str, holds: bool) -> Self {
        self.indistinguishable.extend(holds.then_some(other));
        self
    }
}

/// Name of a joint from its index.
pub fn joint_name(joint: usize) -> String {
    format!("joint{}", joint + 1)
}
