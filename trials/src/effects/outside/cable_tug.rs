//! A cable over two joints.

use super::place::{SHARES, inside};
use crate::effects::scene::{Scene, Shape};
use crate::effects::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism};
use rand::{Rng, RngExt};
use serde_json::json;

/// A cable over two joints that is slack in part of the region and pulls on both in the other part.
#[derive(Debug, Clone)]
struct CableTug {
    /// Indices of the plant's joints on which the mechanism acts.
    joints: [usize; 2],
    /// Positions of both joints at which the cable is straight, rad.
    centre: [f64; 2],
    /// Ratio of the second joint's lever arm to the first's.
    ratio: f64,
    /// Relative length from which the cable pulls.
    slack: f64,
    /// Torque per squared relative length, N·m.
    size: f64,
}

impl Mechanism for CableTug {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let [a, b] = self.joints;
        let (sa, ca) = (now.q[a] - self.centre[0]).sin_cos();
        let (sb, cb) = (now.q[b] - self.centre[1]).sin_cos();
        let stretch = (sa + self.ratio * sb + sa * sb - self.slack).max(0.0);
        let tension = self.size * stretch * stretch;
        force[a] -= tension * ca * (1.0 + sb);
        force[b] -= tension * cb * (self.ratio + sa);
    }
}

/// Cable over two joints. Its size is the torque per squared relative length, N·m.
#[derive(Debug)]
struct Cable {
    joints: [usize; 2],
    centre: [f64; 2],
    ratio: f64,
    slack: f64,
}

pub(super) fn draw(scene: &Scene, joints: [usize; 2], rng: &mut dyn Rng) -> Shape {
    let effect = Cable {
        joints,
        centre: joints.map(|j| inside(scene, j, rng)),
        ratio: rng.random_range(0.5..1.2),
        slack: rng.random_range(-0.1..0.25),
    };
    Shape::on(joints[0], effect, SHARES, rng)
}

impl Withheld for Cable {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.add(CableTug {
            joints: self.joints.map(|j| build.axes[j]),
            centre: self.centre,
            ratio: self.ratio,
            slack: self.slack,
            size,
        });
        Ok(())
    }

    fn describe(&self, _size: f64, _dof: usize) -> Description {
        Description::of_joints(&self.joints, "cable_tug", json!({}))
    }
}
