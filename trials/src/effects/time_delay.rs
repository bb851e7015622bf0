//! Torque that is noted later than motion, or earlier.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use rand::{Rng, RngExt};
use serde_json::json;

/// Time shift; its size is the delay, s.
#[derive(Debug)]
struct Delay {
    sign: f64,
}

/// Draws a shift, in three of four cases a late torque.
pub(super) fn draw(_scene: &Scene, _pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let sign = if rng.random_bool(0.75) { 1.0 } else { -1.0 };
    Some(Shape::anywhere(Delay { sign }, 0.04..0.15, rng))
}

impl Withheld for Delay {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.measurement.delay = self.sign * size;
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        Description::of_arm("time_delay", json!({"delay": self.sign * size}))
    }

    fn largest(&self) -> f64 {
        0.03
    }

    fn smallest(&self) -> f64 {
        0.003
    }
}
