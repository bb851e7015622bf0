//! `backlash`: play in the transmission, q being the motor side. The link stands at q − b·h, h being the sign of the
//! torque through the teeth, rounded because the gap takes time to cross.
//! Confounders: elasticity, presliding hysteresis (reversal of velocity, not of torque).

use super::{Bound, Candidate, Column, Quantity};
use crate::effect::Effect;
use crate::scene::Scene;

/// Torque of half contact relative to the joint's torque.
const SOFTNESS: [f64; 3] = [0.02, 0.06, 0.2];
/// Largest half play, rad: more would be a loose screw.
const MOST_PLAY: f64 = 0.015;
/// Time in which the gap is crossed, s (standard deviation of the rounding).
const CROSSING: [f64; 2] = [0.012, 0.035];

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let dof = scene.dof();
    let mut all = Vec::new();
    for softness in SOFTNESS {
        for crossing in CROSSING {
            let soft = softness * scene.scale.torque[joint];
            let column = Column::whole(dof, move |s| {
                let side = s.rigid.column(joint).mapv(|t| (t / soft).tanh());
                s.departure(joint, &-s.rounded(&side, crossing))
            });
            let play = Quantity::plain("half_play", "rad", Some(joint));
            let bound = Bound::Between(0.0, MOST_PLAY);
            all.push(Candidate::single(Effect::Backlash, joint, play, bound, column));
        }
    }
    all
}
