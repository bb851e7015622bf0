//! A joint whose encoder's zero is off.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use rand::Rng;
use serde_json::json;

/// Joint zero; its size is the offset, rad.
#[derive(Debug)]
struct Zero {
    joint: usize,
    sign: f64,
}

pub(super) fn draw(_scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let (joint, sign) = (pick.any, pick.sign);
    Some(Shape::on(joint, Zero { joint, sign }, 0.04..0.2, rng))
}

impl Withheld for Zero {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let joint = build.axes[self.joint];
        build.arm.shift_zero(joint, self.sign * size);
        Ok(())
    }

    fn describe(&self, size: f64, dof: usize) -> Description {
        let values = json!({"zero": self.sign * size});
        // Turning the last link's frame turns its mass distribution, nothing else.
        let last = self.joint == dof - 1;
        Description::of_joints(&[self.joint], "encoder_offset", values)
            .same_as("link_parameters", last)
    }

    fn largest(&self) -> f64 {
        0.12
    }

    fn smallest(&self) -> f64 {
        0.02
    }
}
