//! A base that does not stand level.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use nalgebra::Vector3;
use physics::robot::RobotError;
use plant::build::Build;
use rand::{Rng, RngExt};
use serde_json::json;
use std::f64::consts::TAU;

/// Tilt of the base. Its size is the angle, rad, about the level axis in `direction`, an angle from x, rad.
#[derive(Debug)]
struct Tilt {
    direction: f64,
}

pub(super) fn draw(_scene: &Scene, _pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let direction = rng.random_range(0.0..TAU);
    Some(Shape::anywhere(Tilt { direction }, 0.04..0.15, rng))
}

impl Withheld for Tilt {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let axis = Vector3::new(self.direction.cos(), self.direction.sin(), 0.0);
        build.arm.tilt(axis * size);
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let values = json!({
            "tilt_x": size * self.direction.cos(),
            "tilt_y": size * self.direction.sin(),
        });
        Description::of_arm("base_tilt", values)
    }

    fn largest(&self) -> f64 {
        0.15
    }

    fn smallest(&self) -> f64 {
        0.02
    }
}
