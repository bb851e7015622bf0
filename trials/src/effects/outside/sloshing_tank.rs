//! Liquid that sloshes in a tank on a link.

use super::place::SHARES;
use crate::effects::scene::{Scene, Shape};
use crate::effects::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism};
use rand::{Rng, RngExt};
use serde_json::json;
use std::f64::consts::TAU;

/// The liquid as a mass on a weak spring, shaken by the joint's acceleration.
#[derive(Debug, Clone)]
struct SloshingTank {
    /// Index of the plant's joint on which the mechanism acts.
    joint: usize,
    /// Inertia of the liquid about the joint, kg·m².
    inertia: f64,
    /// Natural frequency of the liquid, Hz.
    frequency: f64,
    /// Damping ratio of the liquid.
    damping: f64,
    /// Angle of the liquid against the tank, rad.
    angle: f64,
    /// Rate of the liquid's angle against the tank, rad/s.
    rate: f64,
}

impl SloshingTank {
    /// Acceleration by the spring, rad/s².
    fn spring(&self) -> f64 {
        let w = TAU * self.frequency;
        w * w * self.angle + 2.0 * self.damping * w * self.rate
    }
}

impl Mechanism for SloshingTank {
    fn push(&mut self, _now: &Instant, force: &mut [f64]) {
        force[self.joint] += self.inertia * self.spring();
    }

    fn advance(&mut self, now: &Instant, _v: &[f64]) {
        self.rate += now.dt * (-now.a[self.joint] - self.spring());
        self.angle += now.dt * self.rate;
    }
}

/// Tank; its size is the inertia of the liquid, kg·m².
#[derive(Debug)]
struct Tank {
    joint: usize,
    frequency: f64,
    damping: f64,
}

pub(super) fn draw(_scene: &Scene, [joint, _]: [usize; 2], rng: &mut dyn Rng) -> Shape {
    let effect = Tank {
        joint,
        frequency: rng.random_range(0.8..2.0),
        damping: rng.random_range(0.03..0.12),
    };
    Shape::on(joint, effect, SHARES, rng)
}

impl Withheld for Tank {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.add(SloshingTank {
            joint: build.axes[self.joint],
            inertia: size,
            frequency: self.frequency,
            damping: self.damping,
            angle: 0.0,
            rate: 0.0,
        });
        Ok(())
    }

    fn describe(&self, _size: f64, _dof: usize) -> Description {
        let values = json!({"frequency": self.frequency});
        Description::of_joints(&[self.joint], "sloshing_tank", values)
    }
}
