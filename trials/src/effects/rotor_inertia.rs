//! The inertia of a motor's rotor, seen through its gear, that the model does not have.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use rand::Rng;
use serde_json::json;

/// Rotor inertia that the description lacks. Its size is the inertia seen at the joint, kg·m².
#[derive(Debug)]
struct Rotor {
    joint: usize,
}

pub(super) fn draw(_scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let joint = pick.any;
    Some(Shape::on(joint, Rotor { joint }, 0.06..0.3, rng))
}

impl Withheld for Rotor {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let joint = build.axes[self.joint];
        build.armature[joint] += size;
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let values = json!({"inertia": size});
        // The first link turns only about its joint: there both inertias are one.
        let first = self.joint == 0;
        Description::of_joints(&[self.joint], "rotor_inertia", values)
            .same_as("link_parameters", first)
    }
}
