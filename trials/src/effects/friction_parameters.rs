//! Viscous and Coulomb friction that are not those of the model, on one joint or two.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld, joint_name};
use physics::robot::RobotError;
use plant::build::Build;
use rand::{Rng, RngExt};
use serde_json::{Value, json};

/// Wrong friction of some joints. The size is a relative error; each joint has a part of it in Coulomb and a part in
/// viscous friction.
#[derive(Debug)]
struct FrictionError {
    joints: Vec<(usize, f64, f64)>,
}

/// Least remaining part of either friction.
const LEAST: f64 = 0.05;

pub(super) fn draw(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let (any, sign) = (pick.any, pick.sign);
    let other = rng.random_range(0..scene.arm.dof());
    let mut joints = vec![(any, sign, sign * rng.random_range(0.2..1.0))];
    if other != any && rng.random_bool(0.4) {
        joints.push((other, -sign * rng.random_range(0.3..1.0), sign));
    }
    Some(Shape::on(any, FrictionError { joints }, 0.06..0.25, rng))
}

impl Withheld for FrictionError {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        for (j, coulomb, viscous) in &self.joints {
            let friction = &mut build.friction[build.axes[*j]];
            friction.coulomb *= (1.0 + size * coulomb).max(LEAST);
            friction.viscous *= (1.0 + size * viscous).max(LEAST);
        }
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let factors = self.joints.iter().map(|(j, coulomb, viscous)| {
            json!({
                "joint": joint_name(*j),
                "coulomb_factor": (1.0 + size * coulomb).max(LEAST),
                "viscous_factor": (1.0 + size * viscous).max(LEAST),
            })
        });
        let values = json!({"factors": factors.collect::<Vec<Value>>()});
        let on: Vec<usize> = self.joints.iter().map(|j| j.0).collect();
        Description::of_joints(&on, "friction_parameters", values)
    }

    fn largest(&self) -> f64 {
        0.9
    }
}
