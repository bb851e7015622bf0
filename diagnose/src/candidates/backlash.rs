//! `backlash`: play in the transmission, q being the motor side. The link stands at q − b·h, h being the sign of the
//! torque through the teeth, rounded because the gap takes time to cross.
//! Confounders: elasticity, presliding hysteresis (reversal of velocity, not of torque).

use super::{Bound, Candidate, Column, Quantity};
use crate::effect::Effect;
use crate::scene::Scene;
use ndarray::Array1;

/// Torque of half contact relative to the joint's torque.
const SOFTNESS: [f64; 3] = [0.02, 0.06, 0.2];
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
                s.departure(joint, &-rounded(s, &side, crossing))
            });
            let play = Quantity::plain("half_play", "rad", Some(joint));
            all.push(Candidate::single(Effect::Backlash, joint, play, Bound::Positive, column));
        }
    }
    all
}

/// Gaussian smoothing within each segment by three running means.
fn rounded(scene: &Scene, x: &Array1<f64>, deviation: f64) -> Array1<f64> {
    // Three boxes of half width h have the variance h(h + 1).
    let half = ((deviation / scene.scale.step).round() as usize).max(1);
    let mut out = x.clone();
    for s in &scene.motion.segments {
        for _ in 0..3 {
            let mut sums = Vec::with_capacity(s.len() + 1);
            sums.push(0.0);
            for i in s.clone() {
                sums.push(sums[i - s.start] + out[i]);
            }
            for i in 0..s.len() {
                let h = half.min(i).min(s.len() - 1 - i);
                out[s.start + i] = (sums[i + h + 1] - sums[i - h]) / (2 * h + 1) as f64;
            }
        }
    }
    out
}
