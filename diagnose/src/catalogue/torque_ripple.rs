//! `torque_ripple`: torque periodic in the joint's position (cogging, gear meshing). The orders come from the
//! periodogram over position of what a first fit leaves, on unfiltered torque at the recorded rate: a low-pass
//! would remove the ripple of a fast joint; lateness of the torque is taken out of it before. Orders need not be whole.
//! Confounders: none at high orders; below a few cycles per range, gravity and counterbalance.

use super::candidate::{Bound, Candidate, Column, Quantity, Shape};
use super::effect::Effect;
use super::info::{Info, Need};
use super::unit::Unit;
use crate::motion::scene::Scene;
use physics::effects::{Harmonic, Phase, Term};
use std::f64::consts::TAU;

/// Description of `torque_ripple`: confounders, needs, rules.
pub(super) const INFO: Info = Info {
    name: "torque_ripple",
    plain: "torque ripple",
    confounders: &[Effect::Counterbalance, Effect::EncoderOffset],
    vibrates: true,
    least_fraction: 0.06,
    needs: &[Need::Range, Need::Minute, Need::Rate],
    coded: true,
    ..Info::NEW
};

/// Largest number of lines of one joint's ripple.
pub const LINES: usize = 3;

const NAMES: [(&str, &str); LINES] = [
    ("sine_1", "cosine_1"),
    ("sine_2", "cosine_2"),
    ("sine_3", "cosine_3"),
];

/// Cycles over the recorded range that are tried beside the lines of the periodogram, whose lowest order is higher.
const SLOW: [f64; 4] = [1.5, 1.75, 2.0, 2.25];

/// Candidates of a joint with one slow line each, see [`SLOW`].
pub(super) fn slow(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let (low, high) = scene.scale.range[joint];
    let order = |cycles: f64| cycles * TAU / (high - low);
    let moves = high - low >= 1e-4;
    let orders = SLOW.into_iter().filter(|_| moves).map(order);
    orders.flat_map(|k| candidates(joint, &[k])).collect()
}

/// Candidates of a joint with one, two and three lines.
pub fn candidates(joint: usize, orders: &[f64]) -> Vec<Candidate> {
    let column = |order, phase| Column::term(joint, Term::Harmonic(Harmonic { order, phase }));
    (1..=orders.len().min(LINES))
        .map(|n| {
            let mut c = Candidate {
                effect: Effect::TorqueRipple,
                joints: vec![joint],
                driver: None,
                columns: Vec::new(),
                bounds: vec![Bound::Free; 2 * n],
                quantities: Vec::new(),
                shape: orders[..n]
                    .iter()
                    .map(|&k| Shape::new("order", k, Unit::PerRad))
                    .collect(),
                sizes: Vec::new(),
                change: None,
                known: None,
                evidence: 0.0,
                shown: None,
            };
            for (&order, (s, k)) in orders[..n].iter().zip(NAMES) {
                c.columns
                    .extend([column(order, Phase::Sin), column(order, Phase::Cos)]);
                c.quantities
                    .push(Quantity::plain(s, Unit::NewtonMetre, Some(joint)));
                c.quantities
                    .push(Quantity::plain(k, Unit::NewtonMetre, Some(joint)));
            }
            c
        })
        .collect()
}
