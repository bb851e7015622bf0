//! A gear that winds up.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Place, Withheld, Yielding};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::GearSpring;
use rand::{Rng, RngExt};
use serde_json::json;

/// Elastic gear; its size is the compliance, rad/(N·m).
#[derive(Debug)]
struct Elasticity {
    joint: usize,
    /// Deflection at which stiffness has doubled, rad.
    hardening: f64,
    /// Damping ratio of the rotor on its spring.
    ratio: f64,
}

/// Random elastic gear of a joint whose rotor is separate from its link.
pub(super) fn draw(_scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let joint = pick.geared?;
    let effect = Elasticity {
        joint,
        hardening: rng.random_range(0.05..0.2),
        ratio: rng.random_range(0.02..0.08),
    };
    Some(Shape::on(joint, effect, 0.05..0.16, rng))
}

impl Withheld for Elasticity {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let disc = build.arm.disc[self.joint];
        let stiffness = self.stiffness(size);
        let joint = build.split(self.joint);
        build.add(GearSpring {
            joint,
            stiffness,
            hardening: self.hardening,
            damping: 2.0 * self.ratio * (stiffness * disc).sqrt(),
        });
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let values = json!({
            "stiffness": self.stiffness(size),
            "hardening": self.hardening,
            "damping_ratio": self.ratio,
        });
        Description::of_joints(&[self.joint], "gear_spring", values)
    }

    fn smallest(&self) -> f64 {
        1e-6
    }

    fn yielding(&self) -> Option<&dyn Yielding> {
        Some(self)
    }
}

impl Yielding for Elasticity {
    fn place(&self) -> Place {
        Place::Gear(self.joint)
    }

    fn stiffness(&self, size: f64) -> f64 {
        1.0 / size
    }

    fn deflection(&self, size: f64, torque: f64, _usual: f64) -> f64 {
        -size * torque
    }
}
