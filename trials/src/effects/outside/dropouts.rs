//! A drive that loses part of its torque at random for fractions of a second.

use super::place::SHARES;
use crate::effects::scene::{Scene, Shape};
use crate::effects::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism};
use rand::{Rng, RngExt};
use serde_json::json;

/// The losses of one joint's drive.
#[derive(Debug, Clone)]
struct Dropouts {
    /// Index of the plant's joint on which the mechanism acts.
    joint: usize,
    /// Lost share of the torque.
    depth: f64,
    /// Start and end of each loss of torque, s, in order.
    times: Vec<(f64, f64)>,
}

impl Mechanism for Dropouts {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let next = self.times.partition_point(|t| t.0 <= now.t);
        if next > 0 && now.t < self.times[next - 1].1 {
            force[self.joint] -= self.depth * now.load[self.joint];
        }
    }
}

/// Drive that loses torque at random for short times. Its size is the share that it loses.
#[derive(Debug)]
struct Drive {
    joint: usize,
    times: Vec<(f64, f64)>,
}

pub(super) fn draw(scene: &Scene, [joint, _]: [usize; 2], rng: &mut dyn Rng) -> Shape {
    let (start, end) = scene.session.span();
    let mut times = Vec::new();
    let mut t = start;
    while t < end {
        t += exponential(rng, 1.3);
        let stop = t + 0.04 + exponential(rng, 0.15);
        times.push((t, stop));
        t = stop;
    }
    Shape::on(joint, Drive { joint, times }, SHARES, rng)
}

fn exponential(rng: &mut dyn Rng, mean: f64) -> f64 {
    -mean * (1.0 - rng.random::<f64>()).ln()
}

impl Withheld for Drive {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.add(Dropouts {
            joint: build.axes[self.joint],
            depth: size,
            times: self.times.clone(),
        });
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        Description::of_joints(&[self.joint], "torque_dropouts", json!({"depth": size}))
    }

    fn largest(&self) -> f64 {
        0.8
    }
}
