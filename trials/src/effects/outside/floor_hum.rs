//! A machine on the same floor.

use super::place::SHARES;
use crate::effects::scene::{Scene, Shape};
use crate::effects::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism};
use rand::{Rng, RngExt};
use serde_json::json;
use std::f64::consts::TAU;

/// Vibration of fixed frequency that comes and goes.
#[derive(Debug, Clone)]
struct FloorHum {
    /// Index of the plant's joint on which the mechanism acts.
    joint: usize,
    /// Amplitude of the hum's torque, N·m.
    size: f64,
    /// Frequency of the hum, Hz.
    frequency: f64,
    /// Period with which the hum comes and goes, s.
    swell: f64,
}

impl Mechanism for FloorHum {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let swell = 1.0 + 0.5 * (TAU * now.t / self.swell).sin();
        force[self.joint] += self.size * swell * (TAU * self.frequency * now.t).sin();
    }
}

/// Hum; its size is the amplitude, N·m.
#[derive(Debug)]
struct Hum {
    joint: usize,
    frequency: f64,
    swell: f64,
}

pub(super) fn draw(_scene: &Scene, [joint, _]: [usize; 2], rng: &mut dyn Rng) -> Shape {
    let effect = Hum {
        joint,
        frequency: rng.random_range(2.5..9.0),
        swell: rng.random_range(20.0..70.0),
    };
    Shape::on(joint, effect, SHARES, rng)
}

impl Withheld for Hum {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.add(FloorHum {
            joint: build.axes[self.joint],
            size,
            frequency: self.frequency,
            swell: self.swell,
        });
        Ok(())
    }

    fn describe(&self, _size: f64, _dof: usize) -> Description {
        let values = json!({"frequency": self.frequency});
        Description::of_joints(&[self.joint], "floor_hum", values)
    }
}
