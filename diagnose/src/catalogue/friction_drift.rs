//! `friction_drift`: friction that changes over the session. Profiles over the share of the session that has
//! passed, times viscous, Coulomb or both columns. Confounders: one-off errors of friction parameters.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::info::{Info, Need};
use crate::motion::scene::Scene;

/// What is known of it beside its columns.
pub(super) const INFO: Info = Info {
    name: "friction_drift",
    plain: "friction that drifts over the session",
    confounders: &[Effect::FrictionParameters, Effect::NonlinearViscousFriction],
    friction: true,
    needs: &[Need::Minute],
    ..Info::NEW
};

/// Time constants relative to the session; infinity stands for a straight line.
const CONSTANTS: [f64; 4] = [0.1, 0.3, 1.0, f64::INFINITY];

/// 0 at the start of the session, 1 at its end (a share of the way for slow exponentials).
fn profile(progress: f64, constant: f64) -> f64 {
    if constant.is_infinite() {
        progress
    } else {
        1.0 - (-progress.max(0.0) / constant).exp()
    }
}

pub(super) fn candidates(joint: usize) -> Vec<Candidate> {
    let mut all = Vec::new();
    for constant in CONSTANTS {
        // Falling to the given value as well as leaving it: either end may be the model's.
        for end in [0.0, 1.0] {
            let viscous = Column::own(joint, move |s: &Scene| {
                s.progress().mapv(|p| profile(p, constant) - end) * s.motion.qd.column(joint)
            });
            let coulomb = Column::own(joint, move |s: &Scene| {
                s.progress().mapv(|p| profile(p, constant) - end) * s.sign.column(joint)
            });
            let v = || Quantity::plain("viscous", "N·m·s/rad", Some(joint));
            let c = || Quantity::plain("coulomb", "N·m", Some(joint));
            let new =
                |q, column| {
                    Candidate::single(Effect::FrictionDrift, joint, q, Bound::Free, column)
                        .with_shape("time_constant", constant, "session")
                };
            all.push(new(v(), viscous.clone()));
            all.push(new(c(), coulomb.clone()));
            all.push(new(v(), viscous.clone()).and(c(), Bound::Free, coulomb));
        }
    }
    all
}
