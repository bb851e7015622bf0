//! A torque channel that is cut off.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use rand::Rng;
use serde_json::json;

/// Saturated torque of a joint. Its size is the part of the joint's greatest torque (N·m) that is cut off.
#[derive(Debug)]
struct Saturation {
    joint: usize,
    greatest: f64,
}

impl Saturation {
    fn limit(&self, size: f64) -> f64 {
        self.greatest * (1.0 - size)
    }
}

pub(super) fn draw(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let joint = pick.any;
    let greatest = scene.demand.greatest[joint];
    let effect = Saturation { joint, greatest };
    Some(Shape::on(joint, effect, 0.05..0.15, rng))
}

impl Withheld for Saturation {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.measurement.limit[self.joint] = self.limit(size);
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let values = json!({"limit": self.limit(size)});
        Description::of_joints(&[self.joint], "saturation", values)
    }

    fn largest(&self) -> f64 {
        0.6
    }

    fn smallest(&self) -> f64 {
        0.15
    }
}
