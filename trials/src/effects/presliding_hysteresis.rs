//! Friction that bends before it slides.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::Bristle;
use rand::{Rng, RngExt};
use serde_json::json;
use std::f64::consts::TAU;

/// Presliding of a joint's friction. Its size is the bristles' deflection when sliding, rad.
#[derive(Debug)]
pub struct Presliding {
    /// Index of the joint on which the effect acts.
    pub joint: usize,
    /// Part of the deflection that is purely elastic, 0 to 1.
    pub elastic: f64,
    /// Relative increase of Coulomb friction that comes with the presliding.
    pub more: f64,
    /// Micro-damping of the bristles, N·m·s/rad.
    pub damping: f64,
}

pub(super) fn draw(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let joint = pick.any;
    let effect = Presliding {
        joint,
        elastic: rng.random_range(0.05..0.5),
        more: rng.random_range(0.0..0.15),
        damping: 0.3 * scene.inertia[joint] * TAU * 15.0,
    };
    Some(Shape::on(joint, effect, 0.05..0.14, rng))
}

impl Withheld for Presliding {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let joint = build.axes[self.joint];
        // The bristles carry what was the joint's Coulomb friction.
        let coulomb = std::mem::take(&mut build.friction[joint].coulomb);
        build.add(Bristle {
            joint,
            coulomb: coulomb * (1.0 + self.more),
            deflection: size,
            elastic: self.elastic,
            damping: self.damping,
            z: 0.0,
        });
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let values = json!({
            "deflection": size,
            "elastic": self.elastic,
            "coulomb_factor": 1.0 + self.more,
        });
        Description::of_joints(&[self.joint], "bristles", values)
    }

    fn largest(&self) -> f64 {
        0.12
    }

    fn smallest(&self) -> f64 {
        0.002
    }
}
