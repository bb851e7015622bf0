//! Play in a gear.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Place, Withheld, Yielding};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism};
use rand::{Rng, RngExt};
use serde_json::json;
use std::f64::consts::TAU;

/// Play between a rotor and its link: stiff flanks with damping, and nothing between them.
#[derive(Debug, Clone)]
struct GearPlay {
    /// Plant joint of the gear's deflection.
    joint: usize,
    /// Half of the play between the flanks, rad.
    half: f64,
    /// Stiffness of a flank, N·m/rad.
    stiffness: f64,
    /// Damping of a flank in contact, N·m·s/rad.
    damping: f64,
    /// Damping of the grease between the flanks, N·m·s/rad.
    grease: f64,
}

impl GearPlay {
    fn depth(&self, x: f64) -> f64 {
        x - x.clamp(-self.half, self.half)
    }
}

impl Mechanism for GearPlay {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        force[self.joint] -= self.stiffness * self.depth(now.q[self.joint]);
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, now: &Instant, v: f64) -> f64 {
        let touching = self.depth(now.q[self.joint]) != 0.0;
        v * if touching { self.damping } else { self.grease }
    }
}

/// Play in a gear. Its size is half of the play, rad.
#[derive(Debug)]
struct Play {
    joint: usize,
    /// Stiffness of a flank, N·m/rad.
    stiffness: f64,
}

/// Random play in a gear of a joint whose rotor is separate from its link.
pub(super) fn draw(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let joint = pick.geared?;
    let stiffness = scene.inertia[joint] * (TAU * rng.random_range(25.0..40.0)).powi(2);
    let effect = Play { joint, stiffness };
    Some(Shape::on(joint, effect, 0.05..0.15, rng))
}

impl Withheld for Play {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let critical = (self.stiffness * build.arm.disc[self.joint]).sqrt();
        let joint = build.split(self.joint);
        build.add(GearPlay {
            joint,
            half: size,
            stiffness: self.stiffness,
            damping: 0.5 * critical,
            grease: 0.003 * critical,
        });
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let values = json!({"play": 2.0 * size, "flank_stiffness": self.stiffness});
        Description::of_joints(&[self.joint], "gear_play", values)
    }

    fn largest(&self) -> f64 {
        0.02
    }

    fn smallest(&self) -> f64 {
        0.002
    }

    fn yielding(&self) -> Option<&dyn Yielding> {
        Some(self)
    }
}

impl Yielding for Play {
    fn place(&self) -> Place {
        Place::Gear(self.joint)
    }

    fn stiffness(&self, _size: f64) -> f64 {
        self.stiffness
    }

    /// Deflection from flank to flank, rad, softened where the torque is small.
    fn deflection(&self, size: f64, torque: f64, usual: f64) -> f64 {
        let scale = 0.03 * usual;
        -size * (torque / scale).tanh()
    }
}
