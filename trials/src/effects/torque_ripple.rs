//! Cogging and meshing.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::Ripple;
use rand::{Rng, RngExt};
use serde_json::json;
use std::f64::consts::TAU;

/// Ripple of a joint: cogging and meshing. Its size is the amplitude of the first wave, N·m.
#[derive(Debug)]
pub struct CoggingWaves {
    /// Index of the joint on which the effect acts.
    pub joint: usize,
    /// Order (rad⁻¹), amplitude over the size and phase (rad) of each wave.
    pub waves: Vec<[f64; 3]>,
}

/// Random ripple of a joint: two or three waves over its position.
pub(super) fn draw(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let joint = pick.any;
    let first = rng.random_range(5.0..28.0) / scene.reach(joint);
    let mut waves = vec![[first, 1.0, rng.random_range(0.0..TAU)]];
    for _ in 0..rng.random_range(1..3) {
        waves.push([
            first * rng.random_range(1.3..3.7),
            rng.random_range(0.2..0.7),
            rng.random_range(0.0..TAU),
        ]);
    }
    let effect = CoggingWaves { joint, waves };
    Some(Shape::on(joint, effect, 0.05..0.25, rng))
}

impl Withheld for CoggingWaves {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let waves = self.waves.iter().map(|[n, a, p]| [*n, a * size, *p]);
        build.add(Ripple {
            joint: build.axes[self.joint],
            waves: waves.collect(),
        });
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let column = |of: fn(&[f64; 3]) -> f64| self.waves.iter().map(of).collect::<Vec<f64>>();
        let amplitude: Vec<f64> = self.waves.iter().map(|w| w[1] * size).collect();
        let values =
            json!({"order": column(|w| w[0]), "amplitude": amplitude, "phase": column(|w| w[2])});
        Description::of_joints(&[self.joint], "torque_ripple", values)
    }

    fn is_self_contained(&self) -> bool {
        true
    }
}
