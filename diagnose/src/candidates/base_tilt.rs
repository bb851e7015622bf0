//! `base_tilt`: gravity points elsewhere in the base frame. Two small rotations shared by all joints.
//! Confounders: first moments of the links, encoder offset of the first joints, offsets.

use super::{Bound, Candidate, Column, Quantity};
use crate::effect::Effect;
use crate::scene::Scene;
use nalgebra::{Rotation3, Vector3};

/// Angle over which the torque is differenced, rad.
const STEP: f64 = 1e-3;

pub(super) fn candidates(scene: &Scene) -> Vec<Candidate> {
    let dof = scene.dof();
    let column = |axis: Vector3<f64>| {
        Column::whole(dof, move |s| {
            // The base turned by +angle sees gravity turned by −angle.
            let gravity = Rotation3::new(-STEP * axis) * s.robot.gravity();
            s.gravity_change(gravity) / STEP
        })
    };
    vec![Candidate {
        effect: Effect::BaseTilt,
        joints: (0..dof).collect(),
        driver: None,
        columns: vec![column(Vector3::x()), column(Vector3::y())],
        bounds: vec![Bound::Free; 2],
        quantities: vec![
            Quantity::plain("tilt_x", "rad", None),
            Quantity::plain("tilt_y", "rad", None),
        ],
        shape: Vec::new(),
        evidence: 0.0,
    }]
}
