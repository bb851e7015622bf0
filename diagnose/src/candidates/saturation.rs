//! `saturation`: the recorded torque is cut at a limit while the joint received more. The column is the cut of
//! the predicted torque. Confounder: none where the histogram has a flat top; a limit near the peak is invisible.

use super::{Bound, Candidate, Column, Quantity};
use crate::effect::Effect;
use crate::scene::Scene;

/// Limits relative to the largest predicted torque.
const LIMITS: [f64; 10] = [0.3, 0.38, 0.46, 0.54, 0.62, 0.68, 0.74, 0.8, 0.86, 0.92];

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let predicted = &scene.rigid.column(joint) + &scene.drive.column(joint);
    let largest = predicted.iter().fold(0.0f64, |a, x| a.max(x.abs()));
    LIMITS
        .into_iter()
        .map(|share| {
            let limit = share * largest;
            let column = Column::own(joint, move |s| {
                let predicted = &s.rigid.column(joint) + &s.drive.column(joint);
                predicted.mapv(|t| t.clamp(-limit, limit) - t)
            });
            let cut = Quantity::plain("cut", "1", Some(joint));
            Candidate::single(
                Effect::Saturation,
                joint,
                cut,
                Bound::Between(0.7, 1.4),
                column,
            )
            .with_shape("limit", limit, "N·m")
        })
        .collect()
}
