//! `encoder_offset`: a wrong joint zero, q_true = q + zero. One parameter that changes the torque of every
//! joint below it in a known proportion. Confounders: first moments, base tilt (first joints).

use super::{Bound, Candidate, Column, Quantity};
use crate::effect::Effect;
use crate::scene::Scene;

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let column = Column::whole(scene.dof(), move |s| s.tangents[joint].q.clone());
    let zero = Quantity::plain("zero", "rad", Some(joint));
    vec![Candidate::single(
        Effect::EncoderOffset,
        joint,
        zero,
        Bound::Between(-0.5, 0.5),
        column,
    )]
}
