//! A torque channel of the wrong scale.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use rand::Rng;
use serde_json::json;

/// Wrong gain; its size is the deviation from 1.
#[derive(Debug)]
struct Gain {
    joint: usize,
    sign: f64,
}

impl Gain {
    fn gain(&self, size: f64) -> f64 {
        1.0 + self.sign * size
    }
}

pub(super) fn draw(_scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let (joint, sign) = (pick.any, pick.sign);
    Some(Shape::on(joint, Gain { joint, sign }, 0.05..0.25, rng))
}

impl Withheld for Gain {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.measurement.gain[self.joint] = self.gain(size);
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let values = json!({"gain": self.gain(size)});
        Description::of_joints(&[self.joint], "torque_gain", values)
    }

    fn largest(&self) -> f64 {
        0.3
    }
}
