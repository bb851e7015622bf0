//! `friction_drift`: friction that changes over the session. Profiles over the share of the session that has
//! passed, times viscous, Coulomb or both columns. Confounders: one-off errors of friction parameters.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::info::{Info, Need};
use crate::motion::scene::Scene;
use physics::effects::{Drift, Sliding, Term, WarmUp};

/// What is known of it beside its columns.
pub(super) const INFO: Info = Info {
    name: "friction_drift",
    plain: "friction that drifts over the session",
    confounders: &[Effect::FrictionParameters, Effect::NonlinearViscousFriction],
    friction: true,
    needs: &[Need::Minute],
    coded: true,
    ..Info::NEW
};

/// Time constants relative to the session; infinity stands for a straight line.
const CONSTANTS: [f64; 4] = [0.1, 0.3, 1.0, f64::INFINITY];

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let mut all = Vec::new();
    for constant in CONSTANTS {
        // Falling to the given value as well as leaving it: either end may be the model's.
        for end in [0.0, 1.0] {
            let drifting = |friction| Column::terms(joint, terms(scene, friction, constant, end));
            let viscous = drifting(Sliding::Viscous);
            let coulomb = drifting(scene.coulomb(joint));
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

/// Friction times the share of the way that has been gone since the session's start, less `end`: an exponential's
/// 1 − exp(−progress/constant), or the progress itself.
fn terms(scene: &Scene, friction: Sliding, constant: f64, end: f64) -> Vec<(f64, Term)> {
    let (start, stop) = scene.scale.session;
    let span = (stop - start).max(1e-9);
    let plain = Term::Sliding(friction);
    let term = Box::new(plain.clone());
    let mut terms = if constant.is_infinite() {
        let mut drift = Drift {
            term,
            start,
            span,
            neutral: 0.0,
        };
        drift.neutral = scene.mean_over_session(|t| drift.factor(Some(t)));
        vec![(1.0, Term::Drift(drift)), (-end, plain)]
    } else {
        let mut warm_up = WarmUp {
            term,
            time_constant: constant * span,
            start,
            neutral: 0.0,
        };
        warm_up.neutral = scene.mean_over_session(|t| warm_up.factor(Some(t)));
        vec![(-1.0, Term::WarmUp(warm_up)), (1.0 - end, plain)]
    };
    terms.retain(|t| t.0 != 0.0);
    terms
}
