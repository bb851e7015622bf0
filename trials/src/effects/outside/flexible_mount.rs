//! An arm on a flexible mount.

use super::place::SHARES;
use crate::effects::scene::{Scene, Shape};
use crate::effects::withheld::{Description, Place, Withheld, Yielding};
use nalgebra::Vector3;
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism};
use rand::{Rng, RngExt};
use serde_json::json;
use std::f64::consts::PI;

/// Spring and damper of one joint towards zero.
#[derive(Debug, Clone)]
struct SpringDamper {
    /// Index of the plant's joint on which the mechanism acts.
    joint: usize,
    /// Stiffness of the spring, N·m/rad.
    stiffness: f64,
    /// Damping of the damper, N·m·s/rad.
    damping: f64,
}

impl Mechanism for SpringDamper {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        force[self.joint] -= self.stiffness * now.q[self.joint];
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, _now: &Instant, v: f64) -> f64 {
        self.damping * v
    }
}

/// Flexible mount of the arm: a level hinge below the base. Its size is the compliance, rad/(N·m).
#[derive(Debug)]
struct Mount {
    /// Direction of the hinge, a level unit vector.
    axis: Vector3<f64>,
    /// Distance of the hinge below the base, m.
    below: f64,
    /// Mass of the part between hinge and base, kg.
    mass: f64,
    /// Damping ratio of the mount.
    ratio: f64,
}

pub(super) fn draw(scene: &Scene, _joints: [usize; 2], rng: &mut dyn Rng) -> Shape {
    let (s, c) = rng.random_range(0.0..PI).sin_cos();
    let first = scene.arm.joints[0].translation.norm().max(0.1);
    let effect = Mount {
        axis: Vector3::new(c, s, 0.0),
        below: first * rng.random_range(0.5..1.2),
        mass: scene.arm.joints.iter().map(|j| j.link.inertia.mass).sum(),
        ratio: rng.random_range(0.03..0.1),
    };
    Shape::anywhere(effect, SHARES, rng)
}

impl Withheld for Mount {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let below = self.below;
        build.arm.put_on_hinge(self.axis, below, self.mass, 0.3);
        build.insert(0);
        let links = build.arm.joints.iter();
        let mass = links.map(|j| j.link.inertia.mass).sum::<f64>();
        let stiffness = self.stiffness(size);
        build.add(SpringDamper {
            joint: 0,
            stiffness,
            damping: 2.0 * self.ratio * (stiffness * mass * below * below).sqrt(),
        });
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        Description::of_arm("flexible_mount", json!({"stiffness": self.stiffness(size)}))
    }

    fn smallest(&self) -> f64 {
        1e-6
    }

    fn yielding(&self) -> Option<&dyn Yielding> {
        Some(self)
    }
}

impl Yielding for Mount {
    fn place(&self) -> Place {
        Place::Mount
    }

    fn stiffness(&self, size: f64) -> f64 {
        1.0 / size
    }

    fn deflection(&self, size: f64, torque: f64, _usual: f64) -> f64 {
        -size * torque
    }
}
