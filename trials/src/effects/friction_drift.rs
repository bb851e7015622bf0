//! Friction that fades as a gear warms up.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::WarmingGrease;
use rand::{Rng, RngExt};
use serde_json::json;

/// Friction that fades as a gear warms up. Its size is the cold gear's extra friction over the warm gear's friction.
#[derive(Debug)]
struct WarmUp {
    joint: usize,
    /// Exponent of the viscosity at the steady state.
    fading: f64,
    /// Time constant of the warming, s.
    time: f64,
    /// Part of Coulomb friction that warms along.
    coulomb: f64,
    /// Mean power of the joint's friction, W.
    power: f64,
}

pub(super) fn draw(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let joint = pick.any;
    let effect = WarmUp {
        joint,
        fading: rng.random_range(1.2..3.0),
        time: rng.random_range(50.0..160.0),
        coulomb: if rng.random_bool(0.5) { 1.0 } else { 0.0 },
        power: scene.demand.power[joint],
    };
    Some(Shape::on(joint, effect, 0.05..0.2, rng))
}

impl Withheld for WarmUp {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let joint = build.axes[self.joint];
        let friction = build.friction[joint];
        build.add(WarmingGrease {
            joint,
            cold: size,
            fading: self.fading,
            time: self.time,
            power: self.power,
            viscous: friction.viscous,
            coulomb: friction.coulomb * self.coulomb,
            v_eps: friction.v_eps,
            warmth: 0.0,
        });
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let values = json!({
            "cold": size,
            "fading": self.fading,
            "time": self.time,
            "coulomb_share": self.coulomb,
        });
        Description::of_joints(&[self.joint], "warming_grease", values)
    }

    fn largest(&self) -> f64 {
        3.0
    }

    fn is_self_contained(&self) -> bool {
        true
    }
}
