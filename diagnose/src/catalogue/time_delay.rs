//! `time_delay`: torque and motion recorded with a shift in time, shared by all joints: τ(t) = τ̂(t − delay), by
//! interpolation of the whole prediction, friction jumps included. Confounders: presliding (reversals
//! only), elasticity (second derivative), viscous friction of the acceleration.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::info::Info;
use crate::motion::scene::Scene;
use ndarray::{Array1, Array2};

/// What is known of it beside its columns.
pub(super) const INFO: Info = Info {
    name: "time_delay",
    plain: "a time shift between torque and motion",
    confounders: &[Effect::JointElasticity, Effect::Backlash],
    dynamic: true,
    place: Some("MJCF"),
    remedy: "shift the torque in the recording, or delay the actuator ({})",
    ..Info::NEW
};

/// Delays in sampling intervals; the coefficient corrects what lies between.
const DELAYS: [f64; 12] = [
    -12.0, -6.0, -3.0, -1.5, -0.75, 0.75, 1.5, 3.0, 5.0, 8.0, 12.0, 18.0,
];

pub(super) fn candidates(scene: &Scene) -> Vec<Candidate> {
    let dof = scene.dof();
    DELAYS
        .into_iter()
        .map(|steps| {
            let delay = steps * scene.scale.step;
            let column = Column::whole(dof, move |s| {
                let predicted = s.predicted();
                let mut out = Array2::zeros(predicted.dim());
                for j in 0..dof {
                    let own = predicted.column(j).to_owned();
                    out.column_mut(j).assign(&(delayed(s, &own, delay) - own));
                }
                out
            });
            Candidate {
                effect: Effect::TimeDelay,
                joints: (0..dof).collect(),
                driver: None,
                columns: vec![column],
                bounds: vec![Bound::Between(0.6, 1.6)],
                quantities: vec![Quantity::scaled("delay", "s", None, delay)],
                shape: Vec::new(),
                change: None,
                evidence: 0.0,
            }
        })
        .collect()
}

/// x(t − delay) by linear interpolation within each segment, held at its ends.
pub(super) fn delayed(scene: &Scene, x: &Array1<f64>, delay: f64) -> Array1<f64> {
    let time = &scene.motion.time;
    let mut out = Array1::zeros(x.len());
    for s in &scene.motion.segments {
        let mut k = s.start;
        for i in s.clone() {
            let t = time[i] - delay;
            while k + 2 < s.end && time[k + 1] < t {
                k += 1;
            }
            let b = (k + 1).min(s.end - 1);
            let share = if b > k {
                ((t - time[k]) / (time[b] - time[k])).clamp(0.0, 1.0)
            } else {
                0.0
            };
            out[i] = x[k] + share * (x[b] - x[k]);
        }
    }
    out
}
