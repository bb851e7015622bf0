//! A torque channel whose zero is off.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use rand::Rng;
use serde_json::json;

/// Torque bias; its size is the offset, N·m.
#[derive(Debug)]
struct Offset {
    joint: usize,
    sign: f64,
}

pub(super) fn draw(_scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let (joint, sign) = (pick.any, pick.sign);
    Some(Shape::on(joint, Offset { joint, sign }, 0.04..0.2, rng))
}

impl Withheld for Offset {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.measurement.offset[self.joint] = self.sign * size;
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let values = json!({"offset": self.sign * size});
        Description::of_joints(&[self.joint], "torque_offset", values)
            .same_as("asymmetric_friction", true)
    }
}
