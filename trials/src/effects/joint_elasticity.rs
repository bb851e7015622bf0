//! A gear that winds up.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Place, Withheld, Yielding};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde_json::json;

/// Elastic gear between a rotor and its link: a spring that hardens, with damping, on the joint that
/// [`plant::arm::Arm::split_joint`] adds.
#[derive(Debug, Clone)]
struct GearSpring {
    /// Plant joint of the gear's deflection.
    joint: usize,
    /// N·m/rad.
    stiffness: f64,
    /// Deflection at which stiffness has doubled, rad.
    hardening: f64,
    /// N·m·s/rad.
    damping: f64,
}

impl Mechanism for GearSpring {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let x = now.q[self.joint];
        let y = x / self.hardening;
        force[self.joint] -= self.stiffness * x * (1.0 + y * y / 3.0);
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, _now: &Instant, v: f64) -> f64 {
        self.damping * v
    }
}

/// Size: rad/N·m.
#[derive(Debug)]
struct Elasticity {
    joint: usize,
    /// Deflection at which stiffness has doubled, rad.
    hardening: f64,
    /// Damping ratio of the rotor on its spring.
    ratio: f64,
}

/// On a joint whose rotor is told from its link.
pub(super) fn draw(_scene: &Scene, pick: &Pick, rng: &mut ChaCha8Rng) -> Option<Shape> {
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
