//! `asymmetric_friction`: friction that differs between the two directions. Columns |q̇| (viscous) and |sign q̇|
//! (Coulomb; one while the joint moves). Confounder of the latter: torque offset, from which only standstill
//! separates it.

use super::{Bound, Candidate, Column, Quantity};
use crate::effect::Effect;

pub(super) fn candidates(joint: usize) -> Vec<Candidate> {
    let viscous = || Quantity::plain("viscous_difference", "N·m·s/rad", Some(joint));
    let coulomb = || Quantity::plain("coulomb_difference", "N·m", Some(joint));
    let speed = Column::own(joint, move |s| s.motion.qd.column(joint).mapv(f64::abs));
    let moving = Column::own(joint, move |s| s.sign.column(joint).mapv(|x| x * x));
    let new = |q, c| Candidate::single(Effect::AsymmetricFriction, joint, q, Bound::Free, c);
    vec![
        new(viscous(), speed.clone()),
        new(coulomb(), moving.clone()),
        new(viscous(), speed).and(coulomb(), Bound::Free, moving),
    ]
}
