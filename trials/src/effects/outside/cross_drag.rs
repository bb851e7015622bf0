//! Air drag between two joints.

use super::place::SHARES;
use crate::effects::scene::{Scene, Shape};
use crate::effects::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism};
use rand::Rng;
use serde_json::json;

/// Each joint is braked in proportion to its own speed times the other's.
#[derive(Debug, Clone)]
struct CrossDrag {
    /// Indices of the plant's joints on which the mechanism acts.
    joints: [usize; 2],
    /// Torque on each joint at 1 rad/s of both, N·m.
    size: [f64; 2],
}

impl Mechanism for CrossDrag {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let [a, b] = self.joints;
        force[a] -= self.size[0] * now.v[b].abs() * now.v[a];
        force[b] -= self.size[1] * now.v[a].abs() * now.v[b];
    }
}

/// Drag on two joints by the product of their speeds. Its size is the torque on the second joint at 1 rad/s of both,
/// N·m.
#[derive(Debug)]
struct Drag {
    joints: [usize; 2],
    /// Ratio of the torque on the first joint to that on the second.
    ratio: f64,
}

pub(super) fn draw(scene: &Scene, joints: [usize; 2], rng: &mut dyn Rng) -> Shape {
    let [first, second] = joints.map(|j| scene.demand.torque[j]);
    let ratio = first / second;
    Shape::on(joints[0], Drag { joints, ratio }, SHARES, rng)
}

impl Withheld for Drag {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.add(CrossDrag {
            joints: self.joints.map(|j| build.axes[j]),
            size: [size * self.ratio, size],
        });
        Ok(())
    }

    fn describe(&self, _size: f64, _dof: usize) -> Description {
        Description::of_joints(&self.joints, "cross_drag", json!({}))
    }
}
