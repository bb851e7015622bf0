//! `load_dependent_friction`: |load|^p·sign(q̇), the load being the rigid torque of the present model
//! (Bittencourt and Gunnarsson, 2012). Confounders: Coulomb friction under constant load, torque gain.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::info::Info;

/// What is known of it beside its columns.
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
    ..Info::NEW
};

const EXPONENTS: [f64; 3] = [0.7, 1.0, 1.6];

pub(super) fn candidates(joint: usize) -> Vec<Candidate> {
    EXPONENTS
        .into_iter()
        .map(|p| {
            let column = Column::own(joint, move |s| {
                let mut out = s.sign.column(joint).to_owned();
                let size = s.scale.torque[joint];
                out.zip_mut_with(&s.rigid.column(joint), |x, t| {
                    *x *= size * (t.abs() / size).powf(p)
                });
                out
            });
            let load = Quantity::plain("load_coefficient", "1", Some(joint));
            Candidate::single(
                Effect::LoadDependentFriction,
                joint,
                load,
                Bound::Positive,
                column,
            )
            .with_shape("exponent", p, "1")
        })
        .collect()
}
