//! `stribeck_friction`: extra friction near zero velocity that falls as the joint starts to slide,
//! sign(q̇)·exp(−(|q̇|/v_s)^δ). Confounders: Coulomb friction (slow v_s absorbed), presliding, degressive viscous friction
//! (the same curve with the other sign: hence the bound).

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::experiment::Experiment;
use super::info::{Info, Need};
use super::unit::Unit;
use crate::motion::scene::{SOFT_SIGN, Scene};
use physics::effects::{Sliding, Term};

/// Description of `stribeck_friction`: confounders, needs, experiment, rules.
pub(super) const INFO: Info = Info {
    name: "stribeck_friction",
    plain: "Stribeck friction",
    confounders: &[
        Effect::FrictionParameters,
        Effect::NonlinearViscousFriction,
        Effect::PreslidingHysteresis,
    ],
    friction: true,
    least_fraction: 0.06,
    needs: &[Need::Reversals],
    coded: true,
    experiment: Experiment::Speeds,
    ..Info::NEW
};

/// Stribeck velocities relative to the joint's root mean square velocity. A law narrower than the softened sign
/// cannot be told from it. With half as many values, a law between two of them would leave a residual in which
/// a second curve, of viscous friction, pays for itself beside a Stribeck force twice as large.
const VELOCITIES: [f64; 12] = [
    0.015, 0.03, 0.043, 0.06, 0.085, 0.12, 0.17, 0.25, 0.35, 0.5, 0.71, 1.0,
];
/// Least Stribeck velocity over that of the softened sign.
const NARROWEST: f64 = 8.0;
/// Exponents: Tustin's and the Gaussian form.
const EXPONENTS: [f64; 2] = [1.0, 2.0];

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let speed = scene.scale.speed[joint];
    let mut all = Vec::new();
    for v in VELOCITIES {
        for exponent in EXPONENTS {
            let velocity = v * speed;
            if velocity < NARROWEST * scene.scale.softness[joint].max(SOFT_SIGN) {
                continue;
            }
            let column = Column::term(
                joint,
                Term::Sliding(Sliding::SoftStribeck {
                    velocity,
                    exponent,
                    softness: scene.scale.softness[joint],
                }),
            );
            let stribeck = Quantity::plain("stribeck", Unit::NewtonMetre, Some(joint));
            all.push(
                Candidate::single(
                    Effect::StribeckFriction,
                    joint,
                    stribeck,
                    Bound::Positive,
                    column,
                )
                .with_shape("velocity", velocity, Unit::RadPerSecond)
                .with_shape("exponent", exponent, Unit::One),
            );
        }
    }
    all
}
