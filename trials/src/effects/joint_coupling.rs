//! Friction of one joint's transmission caused by another joint's motion.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld, joint_name};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism, soft_sign};
use rand::seq::IndexedRandom;
use rand::{Rng, RngExt};
use serde_json::json;

/// Shared part of the two joints.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    /// A shaft of the driver turning in the driven joint's oil.
    Oil,
    /// A seal between both, slipping by the difference of their speeds (driven turns this many times per turn of
    /// the driver).
    Seal(f64),
    /// A wheel of the driver's gear train held in the driven joint.
    Wheel,
}

/// Torque on the driven joint by the motion of another.
#[derive(Debug, Clone)]
struct SharedPart {
    /// Index of the plant's joint whose motion drives.
    driver: usize,
    /// Index of the plant's joint whose torque changes.
    driven: usize,
    /// Size of the part: N·m·s/rad, N·m, or kg·m², by its kind.
    size: f64,
    /// Speed over which the sign of velocity is softened, rad/s.
    v_eps: f64,
    part: Part,
}

impl Mechanism for SharedPart {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let torque = match self.part {
            Part::Oil => now.v[self.driver],
            Part::Seal(ratio) => {
                let slip = now.v[self.driver] + ratio * now.v[self.driven];
                soft_sign(slip, 20.0 * self.v_eps)
            }
            Part::Wheel => now.a[self.driver],
        };
        force[self.driven] -= self.size * torque;
    }
}

/// Coupling of two joints by a shared part. Its size is that of the part.
#[derive(Debug)]
struct Coupling {
    driver: usize,
    driven: usize,
    part: Part,
}

/// Random coupling between two joints that both turn or both slide.
pub(super) fn draw(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let driven = pick.any;
    let drivers: Vec<usize> = (0..scene.arm.dof())
        .filter(|&j| j != driven && scene.turns(j) == scene.turns(driven))
        .collect();
    let driver = *drivers.choose(rng)?;
    let part = match rng.random_range(0..5) {
        0 | 1 => Part::Oil,
        2 | 3 => Part::Seal(rng.random_range(-0.3..0.3)),
        _ => Part::Wheel,
    };
    let effect = Coupling {
        driver,
        driven,
        part,
    };
    Some(Shape::on(driven, effect, 0.06..0.25, rng))
}

impl Withheld for Coupling {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.add(SharedPart {
            driver: build.axes[self.driver],
            driven: build.axes[self.driven],
            size,
            v_eps: build.v_eps(self.driver),
            part: self.part,
        });
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let driver = joint_name(self.driver);
        let (mechanism, values) = match self.part {
            Part::Oil => ("shared_oil", json!({"driver": driver, "viscous": size})),
            Part::Seal(ratio) => (
                "shared_seal",
                json!({"driver": driver, "coulomb": size, "ratio": ratio}),
            ),
            Part::Wheel => ("shared_wheel", json!({"driver": driver, "inertia": size})),
        };
        Description::of_joints(&[self.driven], mechanism, values)
    }

    fn is_self_contained(&self) -> bool {
        true
    }
}
