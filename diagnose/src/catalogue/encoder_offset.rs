//! `encoder_offset`: a wrong joint zero, q_true = q + zero. One parameter that changes the torque of every
//! joint below it in a known proportion. Small zeros by the torque's derivative; larger ones on a grid, each by the
//! torque at the turned position, where the derivative would be the torque of links whose masses lie elsewhere.
//! Confounders: first moments, base tilt (first joints).

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::info::{Carried, Correction, Info, Need};
use super::unit::Unit;
use crate::motion::scene::Scene;
use physics::batch::rigid_torque;

/// Description of `encoder_offset`: confounders, needs, remedy, rules.
pub(super) const INFO: Info = Info {
    name: "encoder_offset",
    plain: "a wrong joint zero",
    confounders: &[
        Effect::LinkParameters,
        Effect::BaseTilt,
        Effect::Counterbalance,
        Effect::TorqueOffset,
    ],
    absorbable: true,
    place: Some("URDF"),
    correction: Some(Correction::Zero),
    needs: &[Need::Range],
    remedy: "correct the joint's zero ({})",
    carried: |_| Carried::Zero,
    ..Info::NEW
};

/// Largest zero for which the torque's derivative is used, rad: cos falls by less than one percent.
const LINEAR: f64 = 0.14;
/// Larger zeros that are tried, rad.
const LARGER: [f64; 6] = [-0.46, -0.32, -0.2, 0.2, 0.32, 0.46];
/// Bounds of the coefficient that corrects a larger zero.
const AROUND: (f64, f64) = (0.75, 1.3);

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let new = |quantity, bound, column| {
        Candidate::single(Effect::EncoderOffset, joint, quantity, bound, column)
    };
    let slope = Column::whole(scene.dof(), move |s| s.tangent(joint).q.clone());
    let zero = Quantity::plain("zero", Unit::Rad, Some(joint));
    let larger = LARGER.into_iter().map(|angle| {
        let turned = Column::whole(scene.dof(), move |s| {
            let mut q = s.motion.q.clone();
            q.column_mut(joint).mapv_inplace(|x| x + angle);
            rigid_torque(s.robot, &q, &s.motion.qd, &s.motion.qdd) - &s.rigid
        });
        let zero = Quantity::scaled("zero", Unit::Rad, Some(joint), angle);
        new(zero, Bound::Between(AROUND.0, AROUND.1), turned)
    });
    std::iter::once(new(zero, Bound::Between(-LINEAR, LINEAR), slope))
        .chain(larger)
        .collect()
}
