//! `load_dependent_friction`: |load|^p·sign(q̇), the load being the rigid torque of the present model
//! (Bittencourt and Gunnarsson, 2012). Confounders: Coulomb friction under constant load, torque gain.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::experiment::Experiment;
use super::info::Info;
use super::unit::Unit;
use crate::motion::scene::Scene;
use physics::effects::{FrictionShape, LoadFriction, Term};

/// Description of `load_dependent_friction`: confounders, experiment, rules.
pub(super) const INFO: Info = Info {
    name: "load_dependent_friction",
    plain: "load-dependent friction",
    confounders: &[
        Effect::FrictionParameters,
        Effect::TorqueGain,
        Effect::StribeckFriction,
        Effect::PositionDependentFriction,
    ],
    friction: true,
    coded: true,
    experiment: Experiment::Loads,
    ..Info::NEW
};

const EXPONENTS: [f64; 3] = [0.7, 1.0, 1.6];

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    EXPONENTS
        .into_iter()
        .map(|p| {
            // Of the unit of a torque whatever the exponent.
            let size = scene.scale.torque[joint];
            let load = LoadFriction {
                friction: FrictionShape::Sliding(scene.coulomb(joint)),
                exponent: p,
            };
            let column = Column::terms(joint, vec![(size.powf(1.0 - p), Term::Load(load))]);
            let load = Quantity::plain("load_coefficient", Unit::One, Some(joint));
            Candidate::single(
                Effect::LoadDependentFriction,
                joint,
                load,
                Bound::Positive,
                column,
            )
            .with_shape("exponent", p, Unit::One)
        })
        .collect()
}
