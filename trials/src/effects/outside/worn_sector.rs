//! A worn or dirty sector of a joint.

use super::place::{SHARES, inside};
use crate::effects::scene::{Scene, Shape};
use crate::effects::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism, soft_sign};
use rand::{Rng, RngExt};
use serde_json::json;

/// Friction within part of a joint's range.
#[derive(Debug, Clone)]
struct WornSector {
    /// Index of the plant's joint on which the mechanism acts.
    joint: usize,
    /// Friction torque within the sector, N·m.
    size: f64,
    /// Middle of the sector, rad.
    centre: f64,
    /// Half of the sector's width, rad.
    half: f64,
    /// Speed over which the sign of velocity is softened, rad/s.
    v_eps: f64,
}

impl Mechanism for WornSector {
    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, now: &Instant, v: f64) -> f64 {
        let x = (now.q[self.joint] - self.centre) / self.half;
        self.size * (-x.powi(4)).exp() * soft_sign(v, self.v_eps)
    }
}

/// Worn sector; its size is the friction torque, N·m.
#[derive(Debug)]
struct Worn {
    joint: usize,
    centre: f64,
    half: f64,
}

pub(super) fn draw(scene: &Scene, [joint, _]: [usize; 2], rng: &mut dyn Rng) -> Shape {
    let effect = Worn {
        joint,
        centre: inside(scene, joint, rng),
        half: scene.arm.reach[joint] * rng.random_range(0.1..0.3),
    };
    Shape::on(joint, effect, SHARES, rng)
}

impl Withheld for Worn {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.add(WornSector {
            joint: build.axes[self.joint],
            size,
            centre: self.centre,
            half: self.half,
            v_eps: build.v_eps(self.joint),
        });
        Ok(())
    }

    fn describe(&self, _size: f64, _dof: usize) -> Description {
        let values = json!({"centre": self.centre, "half": self.half});
        Description::of_joints(&[self.joint], "worn_sector", values)
    }
}
