//! `nonlinear_viscous_friction`: friction that grows less or more than linearly with velocity: tanh(q̇/v) and
//! sign(q̇)·|q̇|^p. Confounders: Coulomb and viscous friction (a straight line), Stribeck friction.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::experiment::Experiment;
use super::info::{Info, Need};
use super::unit::Unit;
use crate::motion::scene::Scene;
use physics::effects::{Sliding, Term};

/// Description of `nonlinear_viscous_friction`: confounders, needs, experiment, rules.
pub(super) const INFO: Info = Info {
    name: "nonlinear_viscous_friction",
    plain: "nonlinear viscous friction",
    confounders: &[Effect::FrictionParameters, Effect::StribeckFriction],
    friction: true,
    least_fraction: 0.15,
    needs: &[Need::Speed],
    coded: true,
    experiment: Experiment::Speeds,
    ..Info::NEW
};

/// Velocities v of tanh(q̇/v) relative to the joint's root mean square velocity.
const KNEES: [f64; 4] = [0.25, 0.5, 1.0, 2.0];
const EXPONENTS: [f64; 5] = [0.35, 0.65, 1.5, 2.0, 3.0];

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let speed = scene.scale.speed[joint];
    let new = |bound, name, value, unit, terms| {
        let amplitude = Quantity::plain("amplitude", Unit::NewtonMetre, Some(joint));
        Candidate::single(
            Effect::NonlinearViscousFriction,
            joint,
            amplitude,
            bound,
            Column::terms(joint, terms),
        )
        .with_shape(name, value, unit)
    };
    let knees = KNEES.into_iter().map(|k| {
        let velocity = k * speed;
        let term = Term::Sliding(Sliding::Degressive { velocity });
        new(
            Bound::Positive,
            "velocity",
            velocity,
            Unit::RadPerSecond,
            vec![(1.0, term)],
        )
    });
    let powers = EXPONENTS.into_iter().map(|exponent| {
        // Below one the curve is degressive only with a positive amplitude; above one either sign is.
        let bound = if exponent < 1.0 {
            Bound::Positive
        } else {
            Bound::Free
        };
        // Of size one at the usual speed.
        let term = Term::Sliding(Sliding::Power { exponent });
        let terms = vec![(speed.powf(-exponent), term)];
        new(bound, "exponent", exponent, Unit::One, terms)
    });
    knees.chain(powers).collect()
}
