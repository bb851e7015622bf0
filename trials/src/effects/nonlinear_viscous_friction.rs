//! Fluid friction that is not proportional to speed.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Drag, DragKind};
use rand::seq::IndexedRandom;
use rand::{Rng, RngExt};
use serde_json::json;

/// Fluid friction of a joint. Its size is the drag at top speed, N·m.
#[derive(Debug)]
pub struct FluidFriction {
    /// Index of the joint on which the effect acts.
    pub joint: usize,
    /// Velocity up to which the fluid is Newtonian, rad/s.
    pub v_0: f64,
    /// Top speed of the joint, rad/s.
    pub v_top: f64,
    /// Law of the drag over speed.
    pub law: DragKind,
}

pub(super) fn draw(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let joint = pick.any;
    let speed = scene.demand.velocity[joint];
    let law = *[DragKind::Eyring, DragKind::Churning, DragKind::Carreau].choose(rng)?;
    let effect = FluidFriction {
        joint,
        v_0: speed * rng.random_range(0.08..0.5),
        v_top: 2.5 * speed,
        law,
    };
    Some(Shape::on(joint, effect, 0.06..0.25, rng))
}

impl Withheld for FluidFriction {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.add(Drag {
            joint: build.axes[self.joint],
            size,
            v_0: self.v_0,
            v_top: self.v_top,
            kind: self.law,
        });
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let mechanism = match self.law {
            DragKind::Eyring => "eyring_flow",
            DragKind::Churning => "churning_oil",
            DragKind::Carreau => "shear_thinning",
            DragKind::Power(_) => "power_law",
        };
        let values = json!({"size": size, "v_0": self.v_0, "v_top": self.v_top});
        Description::of_joints(&[self.joint], mechanism, values)
    }

    fn is_self_contained(&self) -> bool {
        true
    }
}
