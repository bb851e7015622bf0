//! The described robot and the real one.

use nalgebra::Vector3;
use physics::robot::Joint;
use plant::arm::{Arm, altered};
use plant::mechanism::RestLaw;
use plant::random::log_uniform;
use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;

/// A robot in the simulator's model, and the true one.
pub struct Drawn {
    /// Robot as the simulator's model has it; joints may lack friction.
    pub given: Arm,
    /// Real robot without any effect.
    pub plain: Arm,
    /// Largest relative error of most described inertials; a few links are off by twice as much.
    pub inertial_width: f64,
    /// Largest factor between described and real friction.
    pub friction_width: f64,
    /// Indices of the joints whose friction is not described.
    pub no_friction: Vec<usize>,
}

/// Random robot around `nominal`: as described, and as it really is.
pub fn draw(nominal: &Arm, rng: &mut ChaCha8Rng) -> Drawn {
    let inertial_width = [0.03, 0.1, 0.25][rng.random_range(0..3)];
    let friction_width = [1.1, 2.0, 3.0][rng.random_range(0..3)];
    let (mut given, mut plain) = (nominal.clone(), nominal.clone());
    plain.rest = *RestLaw::ALL.choose(rng).unwrap_or(&RestLaw::Root);
    let sometimes = rng.random_bool(0.3);
    let mut no_friction = Vec::new();
    for (j, joint) in plain.joints.iter_mut().enumerate() {
        alter(joint, inertial_width, friction_width, rng);
        if sometimes && rng.random_bool(0.5) {
            (given.joints[j].damping, given.joints[j].friction) = (0.0, 0.0);
            no_friction.push(j);
        }
    }
    Drawn {
        given,
        plain,
        inertial_width,
        friction_width,
        no_friction,
    }
}

/// Gives a joint and its link errors of up to these widths.
pub fn alter(joint: &mut Joint, inertial_width: f64, friction_width: f64, rng: &mut ChaCha8Rng) {
    // One link in ten is described worse than the rest.
    let width = inertial_width * if rng.random_bool(0.1) { 2.0 } else { 1.0 };
    let body = &joint.link.inertia;
    let shift =
        Vector3::from_fn(|_, _| rng.random_range(-0.57..0.57)) * (width * body.com().norm());
    let mut factor = || log_uniform(rng, 1.0 / (1.0 + width), 1.0 + width);
    let (mass, inertia) = (factor(), factor());
    joint.link.inertia = altered(body, mass, shift, inertia);
    joint.damping *= log_uniform(rng, 1.0 / friction_width, friction_width);
    joint.friction *= log_uniform(rng, 1.0 / friction_width, friction_width);
}

/// The robot on another day: friction up to 10 % different.
pub fn another_day(plain: &Arm, rng: &mut ChaCha8Rng) -> Arm {
    let mut arm = plain.clone();
    for joint in &mut arm.joints {
        joint.damping *= log_uniform(rng, 1.0 / 1.1, 1.1);
        joint.friction *= log_uniform(rng, 1.0 / 1.1, 1.1);
    }
    arm
}
