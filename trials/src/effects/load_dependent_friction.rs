//! Friction that grows with the load on a gear.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::GearMesh;
use rand::Rng;
use serde_json::json;

/// Friction of a gear that grows with the load. Its size is the lost share of the transmitted torque.
#[derive(Debug)]
pub struct LoadFriction {
    /// Index of the joint on which the effect acts.
    pub joint: usize,
}

/// Random load-dependent friction of a joint that gravity loads, if there is one.
pub(super) fn draw(_scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let joint = pick.heavy.unwrap_or(pick.any);
    Some(Shape::on(joint, LoadFriction { joint }, 0.05..0.2, rng))
}

impl Withheld for LoadFriction {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.add(GearMesh {
            joint: build.axes[self.joint],
            loss: size,
            v_eps: build.v_eps(self.joint),
        });
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        Description::of_joints(&[self.joint], "gear_mesh", json!({"loss": size}))
    }

    fn largest(&self) -> f64 {
        0.45
    }

    fn is_self_contained(&self) -> bool {
        true
    }
}
