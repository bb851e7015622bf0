//! Random numbers that several rooms draw.

use nalgebra::Vector3;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

/// A number between `low` and `high`, uniform in its logarithm.
pub fn log_uniform(rng: &mut (impl Rng + ?Sized), low: f64, high: f64) -> f64 {
    (rng.random_range(low.ln()..high.ln())).exp()
}

/// A direction, all equally likely.
pub fn unit_vector(rng: &mut (impl Rng + ?Sized)) -> Vector3<f64> {
    let v = Vector3::from_fn(|_, _| StandardNormal.sample(rng));
    v.try_normalize(1e-6).unwrap_or(Vector3::x())
}
