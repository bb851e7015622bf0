//! `torque_ripple`: torque periodic in the joint's position (cogging, gear meshing). The orders come from the
//! periodogram over position of what a first fit leaves, on unfiltered torque at the recorded rate: a low-pass
//! would remove the ripple of a fast joint. Orders need not be whole.
//! Confounders: none at high orders; below a few cycles per range, gravity and counterbalance.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::info::{Info, Need};
use physics::effects::{Harmonic, Phase, Term};

/// What is known of it beside its columns.
pub(super) const INFO: Info = Info {
    name: "torque_ripple",
    plain: "torque ripple",
    confounders: &[Effect::Counterbalance, Effect::EncoderOffset],
    vibrates: true,
    least_fraction: 0.06,
    needs: &[Need::Range, Need::Minute, Need::Rate],
    ..Info::NEW
};

/// Most lines of one joint.
pub const LINES: usize = 3;

const NAMES: [(&str, &str); LINES] = [
    ("sine_1", "cosine_1"),
    ("sine_2", "cosine_2"),
    ("sine_3", "cosine_3"),
];

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
                shape: orders[..n].iter().map(|&k| ("order", k, "1/rad")).collect(),
                change: None,
                evidence: 0.0,
            };
            for (&order, (s, k)) in orders[..n].iter().zip(NAMES) {
                c.columns
                    .extend([column(order, Phase::Sin), column(order, Phase::Cos)]);
                c.quantities.push(Quantity::plain(s, "N·m", Some(joint)));
                c.quantities.push(Quantity::plain(k, "N·m", Some(joint)));
            }
            c
        })
        .collect()
}
