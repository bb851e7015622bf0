//! Inertias of a body on the last link, once its mass and centre are known.
//!
//! The search gives them priors about zero, as wide as the link's own. A body away from the link's frame has more by its distance
//! alone: 1.5 kg at 0.1 m have 0.015 kg·m², where a flange has 0.001. A fit that is held to such priors is no possible body, and
//! moving it to a possible one moved its mass by a third.

use crate::algebra::fit::Variable;
use crate::search::select::MOMENTS;
use nalgebra::{Matrix3, Vector3};
use physics::robot::Inertia;

/// Centres the priors of the body's inertias on those of its fitted mass at its fitted centre (parallel axes), and widens them by the
/// part `freed` of these. `body` are its ten variables, `beta` their coefficients. A mass that is not above zero leaves them as they are.
pub(super) fn centre(body: &mut [Variable], beta: &[f64], freed: f64) {
    let [mass, x, y, z, ..] = *beta else { return };
    if mass <= 0.0 {
        return;
    }
    let centre = Vector3::new(x, y, z) / mass;
    let point = Inertia::from_com(mass, centre, Matrix3::zeros()).parameters();
    let by_distance = freed * mass * centre.norm_squared();
    for (variable, mean) in body.iter_mut().zip(point).skip(MOMENTS) {
        variable.mean = mean;
        variable.precision = 1.0 / (1.0 / variable.precision + by_distance.powi(2));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inertias_are_those_of_the_mass_at_its_centre() {
        let mut body: Vec<Variable> = (0..10).map(|c| Variable::about_zero(c, 1e6)).collect();
        let beta = [2.0, 0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        centre(&mut body, &beta, 0.5);
        let means: Vec<f64> = body.iter().map(|v| v.mean).collect();
        // Two kilograms at 0.1 m along x: 0.02 kg·m² about y and z.
        let about = [0.0, 0.0, 0.02, 0.0, 0.0, 0.02];
        assert!(
            means[4..]
                .iter()
                .zip(about)
                .all(|(m, a)| (m - a).abs() < 1e-15)
        );
        assert_eq!((means[0], body[3].precision), (0.0, 1e6));
        // Half of 0.02, beside the link's own 0.001.
        let deviation = body[4].precision.powf(-0.5);
        assert!((deviation - 0.01_f64.hypot(0.001)).abs() < 1e-12);
        let before = body.clone();
        centre(&mut body, &[-1.0, 0.2, 0.0, 0.0], 0.5);
        assert_eq!(body, before);
    }
}
