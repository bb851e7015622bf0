//! `base_tilt`: gravity points elsewhere in the base frame. Two small rotations shared by all joints.
//! Confounders: first moments of the links, encoder offset of the first joints, offsets.

use super::{Bound, Candidate, Column, Quantity};
use crate::effect::Effect;
use crate::scene::Scene;
use nalgebra::{Rotation3, Vector3};
use ndarray::Array2;

/// Angle over which the torque is differenced, rad.
const STEP: f64 = 1e-3;
/// Torque of one direction over that of the direction across it below which it cannot be known: an arm with parallel
/// axes does not feel a tilt about a line across them.
const SEEN: f64 = 0.1;

pub(super) fn candidates(scene: &Scene) -> Vec<Candidate> {
    let dof = scene.dof();
    let about = |axis: Vector3<f64>| Column::whole(dof, move |s| change(s, axis));
    let tilt = |name| Quantity::plain(name, "rad", None);
    let (angle, seen) = directions(scene);
    let (columns, quantities, shape) = if seen < SEEN {
        let axis = Vector3::new(angle.cos(), angle.sin(), 0.0);
        let direction = vec![("direction", angle, "rad")];
        (vec![about(axis)], vec![tilt("tilt")], direction)
    } else {
        let columns = vec![about(Vector3::x()), about(Vector3::y())];
        (columns, vec![tilt("tilt_x"), tilt("tilt_y")], Vec::new())
    };
    vec![Candidate {
        effect: Effect::BaseTilt,
        joints: (0..dof).collect(),
        driver: None,
        bounds: vec![Bound::Free; columns.len()],
        columns,
        quantities,
        shape,
        evidence: 0.0,
    }]
}

/// Angle from x of the horizontal line about which a tilt changes the torque most, rad, and how much less it does about
/// the line across.
fn directions(scene: &Scene) -> (f64, f64) {
    let [x, y] = [Vector3::x(), Vector3::y()].map(|axis| change(scene, axis));
    let product = |a: &Array2<f64>, b: &Array2<f64>| -> f64 {
        let of = |j: usize| a.column(j).dot(&b.column(j)) / scene.scale.torque[j].powi(2);
        (0..scene.dof()).map(of).sum()
    };
    let (xx, xy, yy) = (product(&x, &x), product(&x, &y), product(&y, &y));
    let (mean, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    let least = (mean - half).max(0.0) / (mean + half).max(f64::MIN_POSITIVE);
    (0.5 * (2.0 * xy).atan2(xx - yy), least.sqrt())
}

/// Torque per angle of the base turned about an axis, N·m/rad.
fn change(scene: &Scene, axis: Vector3<f64>) -> Array2<f64> {
    // The base turned by +angle sees gravity turned by −angle.
    let gravity = Rotation3::new(-STEP * axis) * scene.robot.gravity();
    scene.gravity_change(gravity) / STEP
}
