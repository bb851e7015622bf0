//! The real robot of a plain case.

use nalgebra::Vector3;
use plant::arm::{Arm, altered};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// A robot slightly different from `nominal`: inertials by up to 3 %, friction by up to 10 %.
pub fn nearly(nominal: &Arm, rng: &mut ChaCha8Rng) -> Arm {
    let mut arm = nominal.clone();
    for joint in &mut arm.joints {
        let body = &joint.link.inertia;
        let shift = Vector3::from_fn(|_, _| rng.random_range(-0.017..0.017)) * body.com().norm();
        let (mass, inertia) = (rng.random_range(0.97..1.03), rng.random_range(0.97..1.03));
        joint.link.inertia = altered(body, mass, shift, inertia);
        joint.damping *= rng.random_range(0.9..1.1);
        joint.friction *= rng.random_range(0.9..1.1);
    }
    arm
}
