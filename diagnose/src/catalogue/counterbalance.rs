//! `counterbalance`: a torque that depends on the joint's own position. Legendre polynomials over the recorded
//! range, of rising degree, describe springs, gas and hydraulic cylinders alike. Confounders: gravity of the
//! links beyond (its sines and cosines), torque offset (degree 0 alone).

use super::candidate::{Bound, Candidate, Column, Quantity, Shape};
use super::effect::Effect;
use super::info::{Info, Need};
use super::unit::Unit;
use crate::motion::scene::Scene;
use physics::effects::{Polynomial, Term};

/// Description of `counterbalance`: confounders, needs, remedy, rules.
pub(super) const INFO: Info = Info {
    name: "counterbalance",
    plain: "a counterbalance",
    confounders: &[
        Effect::LinkParameters,
        Effect::EncoderOffset,
        Effect::BaseTilt,
        Effect::TorqueRipple,
    ],
    absorbable: true,
    needs: &[Need::Range],
    remedy: "add a passive torque of the joint's position ({})",
    coded: true,
    ..Info::NEW
};

const NAMES: [&str; 5] = ["degree_0", "degree_1", "degree_2", "degree_3", "degree_4"];

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let (low, high) = scene.scale.range[joint];
    let (middle, half) = ((low + high) / 2.0, ((high - low) / 2.0).max(1e-6));
    let column = |degree| {
        let shape = Polynomial {
            degree,
            middle,
            half,
        };
        Column::term(joint, Term::Polynomial(shape))
    };
    let columns: Vec<Column> = (0..NAMES.len()).map(column).collect();
    [1, 2, 4]
        .into_iter()
        .map(|degree| Candidate {
            effect: Effect::Counterbalance,
            joints: vec![joint],
            driver: None,
            columns: columns[..=degree].to_vec(),
            bounds: vec![Bound::Free; degree + 1],
            quantities: NAMES[..=degree]
                .iter()
                .map(|n| Quantity::plain(n, Unit::NewtonMetre, Some(joint)))
                .collect(),
            shape: vec![
                Shape::new("middle", middle, Unit::Rad),
                Shape::new("half_range", half, Unit::Rad),
            ],
            sizes: Vec::new(),
            change: None,
            known: None,
            evidence: 0.0,
            shown: None,
        })
        .collect()
}
