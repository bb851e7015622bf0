//! `encoder_offset`: a wrong joint zero, q_true = q + zero. One parameter that changes the torque of every
//! joint below it in a known proportion. Confounders: first moments, base tilt (first joints).

use super::{Bound, Candidate, Column, Quantity};
use crate::effect::Effect;
use crate::scene::Scene;
use ndarray::Array2;

/// Angle over which the torque is differenced, rad.
const STEP: f64 = 1e-3;

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let column = Column::whole(scene.dof(), move |s| {
        let zero = Array2::zeros(s.motion.q.dim());
        let mut dq = zero.clone();
        dq.column_mut(joint).fill(STEP);
        s.rigid_change(&dq, &zero, &zero) / STEP
    });
    let zero = Quantity::plain("zero", "rad", Some(joint));
    vec![Candidate::single(Effect::EncoderOffset, joint, zero, Bound::Between(-0.5, 0.5), column)]
}
