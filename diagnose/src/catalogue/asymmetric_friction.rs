//! `asymmetric_friction`: friction that differs between the two directions. Columns |q̇| (viscous) and sign² q̇
//! (Coulomb; one while the joint moves). Confounder of the latter: torque offset, from which only standstill
//! separates it.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::info::{Info, Need};
use super::unit::Unit;
use crate::motion::scene::Scene;
use physics::effects::{Sliding, Term};

/// Description of `asymmetric_friction`: confounders, needs, rules.
pub(super) const INFO: Info = Info {
    name: "asymmetric_friction",
    plain: "friction that differs by direction",
    confounders: &[Effect::TorqueOffset, Effect::FrictionParameters],
    friction: true,
    needs: &[Need::Reversals],
    coded: true,
    ..Info::NEW
};

/// Speed below which a joint stands, rad/s (m/s), and the largest part of the time that it may stand.
const STANDING: (f64, f64) = (0.01, 0.2);

/// Evidence for a bias of the torque channel against a difference of Coulomb friction, nats. Both have the same
/// torque wherever the joint moves.
const BIAS: f64 = 2.0;

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let viscous = || {
        Quantity::plain(
            "viscous_difference",
            Unit::NewtonMetreSecondPerRad,
            Some(joint),
        )
    };
    let coulomb = || Quantity::plain("coulomb_difference", Unit::NewtonMetre, Some(joint));
    let speed = Column::term(joint, Term::Sliding(Sliding::AsymmetricViscous));
    let velocity = scene.scale.softness[joint];
    let moving = Column::term(
        joint,
        Term::Sliding(Sliding::AsymmetricCoulomb { velocity }),
    );
    let new = |q, c| Candidate::single(Effect::AsymmetricFriction, joint, q, Bound::Free, c);
    let against = |c: Candidate| Candidate {
        evidence: -BIAS,
        shown: None,
        ..c
    };
    let qd = scene.motion.qd.column(joint);
    let standing = qd.iter().filter(|v| v.abs() < STANDING.0).count();
    if standing as f64 > STANDING.1 * qd.len() as f64 {
        // What a joint holds at rest is its history's: the difference between rest and motion would be named.
        return vec![new(viscous(), speed)];
    }
    vec![
        new(viscous(), speed.clone()),
        against(new(coulomb(), moving.clone())),
        new(viscous(), speed).and(coulomb(), Bound::Free, moving),
    ]
}
