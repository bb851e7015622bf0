//! `torque_gain` and `torque_offset`: errors of one joint's torque channel.
//!
//! The gain's column is the torque that the model predicts, never the measured one: a regressor that
//! contains the noise it is to explain always gains. Confounders of the gain: the joint's own
//! inertial and friction parameters taken together; of the offset: Coulomb friction that differs by
//! direction, and gravity of links that hardly turn.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::experiment::Experiment;
use super::info::{Carried, Info};
use super::saturation;
use super::unit::Unit;
use crate::motion::scene::Scene;
use physics::effects::Term;

/// Description of `torque_offset`: confounders, remedy, experiment, rules.
pub(super) const OFFSET: Info = Info {
    name: "torque_offset",
    plain: "a torque offset",
    confounders: &[Effect::AsymmetricFriction, Effect::Counterbalance],
    remedy: "take the bias off the torque ({})",
    carried: |_| Carried::Offset,
    experiments: &[(Effect::AsymmetricFriction, Experiment::Rests)],
    ..Info::NEW
};

/// Description of `torque_gain`: confounders, remedy, experiment, rules.
pub(super) const GAIN: Info = Info {
    name: "torque_gain",
    plain: "a wrong torque scale",
    confounders: &[
        Effect::LinkParameters,
        Effect::FrictionParameters,
        Effect::Payload,
        Effect::LoadDependentFriction,
    ],
    absorbable: true,
    remedy: "correct the torque constant or gear ratio ({})",
    by_mass: true,
    carried: |_| Carried::Gain,
    experiment: Experiment::Loads,
    ..Info::NEW
};

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let gain = Candidate::single(
        Effect::TorqueGain,
        joint,
        Quantity {
            name: "gain",
            unit: Unit::One,
            joint: Some(joint),
            offset: 1.0,
            factor: 1.0,
        },
        Bound::Between(-0.9, 4.0),
        Column::own(joint, move |s| {
            &s.rigid.column(joint) + &s.drive.column(joint)
        }),
    );
    let offset = Candidate::single(
        Effect::TorqueOffset,
        joint,
        Quantity::plain("offset", Unit::NewtonMetre, Some(joint)),
        Bound::Free,
        Column::term(joint, Term::Offset),
    );
    [gain, offset]
        .into_iter()
        .chain(saturation::candidates(scene, joint))
        .collect()
}
