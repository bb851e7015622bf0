//! `joint_elasticity`: a compliant transmission, q being the motor side. The link stands at q_link = q − T/K, T being
//! the torque through the spring, which is the rigid torque of the link's own motion: two fixed-point
//! steps. The whole rigid model is evaluated there, so that the neighbours' torques change too.
//! Confounders: backlash (odd in T but flat), delay (first derivative), rotor and link inertia.

use super::{Bound, Candidate, Column, Quantity};
use crate::effect::Effect;
use crate::scene::Scene;
use ndarray::Array2;

/// Frequencies of the joint's own oscillation against the rigid arm, Hz.
const FREQUENCIES: [f64; 5] = [4.0, 6.5, 10.0, 16.0, 26.0];

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let inertia = own_inertia(scene, joint);
    FREQUENCIES
        .into_iter()
        .map(|f| {
            let stiffness = inertia * (std::f64::consts::TAU * f).powi(2);
            let column = Column::whole(scene.dof(), move |s| compliant(s, joint, 1.0 / stiffness));
            // The column is nearly proportional to 1/K: the coefficient corrects the compliance.
            let compliance = Quantity::scaled("compliance", "rad/(N·m)", Some(joint), 1.0 / stiffness);
            Candidate::single(Effect::JointElasticity, joint, compliance, Bound::Between(0.4, 2.5), column)
        })
        .collect()
}

/// Change of the rigid torque by a transmission of the given compliance, rad/(N·m).
fn compliant(scene: &Scene, joint: usize, compliance: f64) -> Array2<f64> {
    let mut change = Array2::zeros(scene.rigid.dim());
    for _ in 0..2 {
        let spring = &scene.rigid.column(joint) + &change.column(joint);
        let wind_up = spring * -compliance;
        let rate = scene.derivative(&wind_up);
        let acceleration = scene.derivative(&rate);
        let table = |x: &ndarray::Array1<f64>| {
            let mut t = Array2::zeros(scene.rigid.dim());
            t.column_mut(joint).assign(x);
            t
        };
        change = scene.rigid_change(&table(&wind_up), &table(&rate), &table(&acceleration));
    }
    change
}

/// Mean inertia that the joint turns, kg·m², over a few poses of the recording.
pub(super) fn own_inertia(scene: &Scene, joint: usize) -> f64 {
    const POSES: usize = 50;
    let stride = (scene.len() / POSES).max(1);
    let rows: Vec<usize> = (0..scene.len()).step_by(stride).collect();
    let q = scene.motion.q.select(ndarray::Axis(0), &rows);
    let zero = Array2::zeros(q.dim());
    let mut qdd = zero.clone();
    qdd.column_mut(joint).fill(1.0);
    let at_rest = crate::scene::rigid_torque(scene.robot, &q, &zero, &zero);
    let accelerated = crate::scene::rigid_torque(scene.robot, &q, &zero, &qdd);
    let change = accelerated - at_rest;
    (change.column(joint).sum() / rows.len() as f64).max(1e-9)
}
