//! Extra friction of a joint that starts to slide.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Stribeck, StribeckKind};
use rand::{Rng, RngExt};
use serde_json::json;

/// Extra friction of a joint that starts. Its size is the torque at standstill, N·m.
#[derive(Debug)]
pub struct StartingFriction {
    /// Index of the joint on which the effect acts.
    pub joint: usize,
    /// Speed at which the extra friction has mostly gone, rad/s.
    pub v_s: f64,
    /// Law of the fall with speed.
    pub law: StribeckKind,
}

pub(super) fn draw(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let joint = pick.any;
    let law = match rng.random_range(0..3) {
        0 => StribeckKind::Lorentz,
        1 => StribeckKind::HalfCosine,
        _ => StribeckKind::Film(rng.random_range(0.01..0.04)),
    };
    let v_s = scene.demand.velocity[joint] * rng.random_range(0.12..0.5);
    let effect = StartingFriction { joint, v_s, law };
    Some(Shape::on(joint, effect, 0.06..0.25, rng))
}

impl Withheld for StartingFriction {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.add(Stribeck {
            joint: build.axes[self.joint],
            size,
            v_s: self.v_s,
            v_eps: build.v_eps(self.joint),
            kind: self.law,
            film: 0.0,
        });
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let v_s = self.v_s;
        let (mechanism, values) = match self.law {
            StribeckKind::Lorentz => ("stribeck_lorentz", json!({"stribeck": size, "v_s": v_s})),
            StribeckKind::HalfCosine => (
                "stribeck_half_cosine",
                json!({"stribeck": size, "v_s": v_s}),
            ),
            StribeckKind::Film(time) => (
                "lubricant_film",
                json!({"stribeck": size, "v_s": v_s, "time": time}),
            ),
        };
        Description::of_joints(&[self.joint], mechanism, values)
    }

    fn is_self_contained(&self) -> bool {
        true
    }
}
