//! A torque that wanders at random.

use super::place::SHARES;
use crate::effects::scene::{Scene, Shape};
use crate::effects::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use serde_json::json;
use std::f64::consts::PI;

/// Half cosines between random knots.
#[derive(Debug, Clone)]
struct WanderingOffset {
    /// Index of the plant's joint on which the mechanism acts.
    joint: usize,
    /// Root mean square of the knots, N·m.
    size: f64,
    /// Time of the first knot, s.
    start: f64,
    /// Time between knots, s.
    step: f64,
    /// Values of the torque at the knots, of unit deviation.
    knots: Vec<f64>,
}

impl Mechanism for WanderingOffset {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let x = ((now.t - self.start) / self.step).max(0.0);
        let k = (x as usize).min(self.knots.len().saturating_sub(2));
        if let [a, b, ..] = self.knots[k..] {
            let u = (x - k as f64).min(1.0);
            force[self.joint] += self.size * (a + (b - a) * 0.5 * (1.0 - (PI * u).cos()));
        }
    }
}

/// Wandering torque; its size is the root mean square of the knots, N·m.
#[derive(Debug)]
struct Wander {
    joint: usize,
    step: f64,
    knots: Vec<f64>,
}

/// Part of a knot's value that the next one keeps.
const MEMORY: f64 = 0.75;

pub(super) fn draw(scene: &Scene, [joint, _]: [usize; 2], rng: &mut dyn Rng) -> Shape {
    let step = rng.random_range(0.6..1.5);
    let (_, end) = scene.session.span();
    let mut value = 0.0;
    let knots = (0..((end + 10.0) / step) as usize).map(|_| {
        let kick: f64 = StandardNormal.sample(rng);
        value = MEMORY * value + (1.0 - MEMORY * MEMORY).sqrt() * kick;
        value
    });
    let knots = knots.collect();
    Shape::on(joint, Wander { joint, step, knots }, SHARES, rng)
}

impl Withheld for Wander {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.add(WanderingOffset {
            joint: build.axes[self.joint],
            size,
            // Before the controller settles.
            start: -5.0,
            step: self.step,
            knots: self.knots.clone(),
        });
        Ok(())
    }

    fn describe(&self, _size: f64, _dof: usize) -> Description {
        Description::of_joints(
            &[self.joint],
            "wandering_torque",
            json!({"step": self.step}),
        )
    }
}
