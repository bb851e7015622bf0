//! Place and share of a mechanism outside the catalogue.

use crate::effects::scene::Scene;
use rand::{Rng, RngExt};
use std::ops::Range;

/// Range of the share of the joint's torque that a mechanism makes.
pub const SHARES: Range<f64> = 0.1..0.35;

/// A place of joint `j` away from the ends of its region, rad.
pub fn inside(scene: &Scene, j: usize, rng: &mut dyn Rng) -> f64 {
    scene.arm.centre[j] + scene.arm.reach[j] * rng.random_range(-0.4..0.4)
}
