//! `nonlinear_viscous_friction`: friction that grows less or more than linearly with velocity: tanh(q̇/v) and
//! sign(q̇)·|q̇|^p. Confounders: Coulomb and viscous friction (a straight line), Stribeck friction.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::info::{Info, Need};
use crate::motion::scene::Scene;

/// What is known of it beside its columns.
pub(super) const INFO: Info = Info {
    name: "nonlinear_viscous_friction",
    plain: "nonlinear viscous friction",
    confounders: &[Effect::FrictionParameters, Effect::StribeckFriction],
    friction: true,
    needs: &[Need::Speed],
    ..Info::NEW
};

/// Knees relative to the joint's root mean square velocity.
const KNEES: [f64; 4] = [0.25, 0.5, 1.0, 2.0];
const EXPONENTS: [f64; 5] = [0.35, 0.65, 1.5, 2.0, 3.0];

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let speed = scene.scale.speed[joint];
    let new = |bound, name, value, unit, f: Box<dyn Fn(f64) -> f64 + Send + Sync>| {
        let column = Column::own(joint, move |s| s.motion.qd.column(joint).mapv(&f));
        let amplitude = Quantity::plain("amplitude", "N·m", Some(joint));
        Candidate::single(
            Effect::NonlinearViscousFriction,
            joint,
            amplitude,
            bound,
            column,
        )
        .with_shape(name, value, unit)
    };
    let knees = KNEES.into_iter().map(|k| {
        let knee = k * speed;
        new(
            Bound::Positive,
            "velocity",
            knee,
            "rad/s",
            Box::new(move |v| (v / knee).tanh()),
        )
    });
    let powers = EXPONENTS.into_iter().map(|p| {
        // Below one the curve is degressive only with a positive amplitude; above one either sign is.
        let bound = if p < 1.0 {
            Bound::Positive
        } else {
            Bound::Free
        };
        new(
            bound,
            "exponent",
            p,
            "1",
            Box::new(move |v| v.signum() * (v.abs() / speed).powf(p)),
        )
    });
    knees.chain(powers).collect()
}
