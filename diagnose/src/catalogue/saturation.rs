//! `saturation`: the recorded torque is cut at a limit while the joint received more. The column is the cut of
//! the predicted torque. Confounder: none where the histogram has a flat top; a limit near the peak is invisible.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::info::{Carried, Info};
use super::unit::Unit;
use crate::motion::scene::Scene;

/// Shape: the torque at which it is cut.
pub const LIMIT: &str = "limit";

/// What is known of it beside its columns.
pub(super) const INFO: Info = Info {
    name: "saturation",
    plain: "a saturated torque signal",
    confounders: &[Effect::TorqueGain, Effect::NonlinearViscousFriction],
    remedy: "leave out cut samples, or limit the actuator ({})",
    carried: |_| Carried::Limit,
    ..Info::NEW
};

/// Limits relative to the largest predicted torque.
const LIMITS: [f64; 10] = [0.3, 0.38, 0.46, 0.54, 0.62, 0.68, 0.74, 0.8, 0.86, 0.92];

/// What a flat top of the recorded torque is worth, nats.
const FLAT_TOP: f64 = 40.0;

/// Deviation of the cut from that of the predicted torque, whose peaks err, where the recording shows the limit.
const CUT: f64 = 0.15;

/// The limit of a flat top in the recorded torque: what lies above it in the prediction is cut, all of it. Where only one trajectory
/// reaches the limit no other could foretell how much.
pub fn flat_top(joint: usize, limit: f64) -> Candidate {
    let mut candidate = cut(joint, limit);
    candidate.evidence = FLAT_TOP;
    candidate.known = Some((1.0, CUT));
    candidate
}

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let predicted = &scene.rigid.column(joint) + &scene.drive.column(joint);
    let largest = predicted.iter().fold(0.0f64, |a, x| a.max(x.abs()));
    LIMITS
        .into_iter()
        .map(|share| cut(joint, share * largest))
        .collect()
}

fn cut(joint: usize, limit: f64) -> Candidate {
    let column = Column::own(joint, move |s| {
        let predicted = &s.rigid.column(joint) + &s.drive.column(joint);
        predicted.mapv(|t| t.clamp(-limit, limit) - t)
    });
    let cut = Quantity::plain("cut", Unit::One, Some(joint));
    let bound = Bound::Between(0.7, 1.4);
    Candidate::single(Effect::Saturation, joint, cut, bound, column).with_shape(
        LIMIT,
        limit,
        Unit::NewtonMetre,
    )
}
