//! `saturation`: the recorded torque is cut at a limit while the joint received more. The column is the cut of
//! the predicted torque. Confounder: none where the histogram has a flat top; a limit near the peak is invisible.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::info::{Carried, Info};
use super::unit::Unit;
use crate::motion::scene::Scene;

/// Name of the shape parameter: torque at which the signal is cut, N·m (N).
pub const LIMIT: &str = "limit";

/// Description of `saturation`: confounders, remedy, rules.
pub(super) const INFO: Info = Info {
    name: "saturation",
    plain: "a saturated torque signal",
    confounders: &[Effect::TorqueGain, Effect::NonlinearViscousFriction],
    remedy: "leave out cut samples, or limit the actuator ({})",
    carried: |_| Carried::Limit,
    unplanned: "it shows from a limit just below the largest torque of the motion",
    ..Info::NEW
};

/// Limits that are tried, relative to the largest predicted torque.
const LIMITS: [f64; 10] = [0.3, 0.38, 0.46, 0.54, 0.62, 0.68, 0.74, 0.8, 0.86, 0.92];

/// Evidence of a flat top of the recorded torque, nats.
const FLAT_TOP: f64 = 40.0;

/// Standard deviation of the cut where the recording shows the limit, relative to the predicted cut, whose peaks err.
const CUT: f64 = 0.15;

/// Candidate with the limit of a flat top in the recorded torque: all predicted torque above it is cut. Where
/// only one trajectory reaches the limit, no other could predict the coefficient.
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
