//! `presliding_hysteresis`: friction with memory of displacement, by stop operators (one Maxwell-slip element) and
//! Dahl's state over a grid of widths. The state runs on from one trajectory to the next.
//!
//! Two forms of each: friction on top of the Coulomb friction that the model has, and memory that replaces the
//! jump of that friction (state minus sign). Confounders: Stribeck friction, backlash, a delay.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::info::{Info, Need};
use crate::motion::scene::Scene;
use physics::effects::{Dahl, Stop, Term};

/// What is known of it beside its columns.
pub(super) const INFO: Info = Info {
    name: "presliding_hysteresis",
    plain: "presliding hysteresis",
    confounders: &[
        Effect::FrictionParameters,
        Effect::StribeckFriction,
        Effect::Backlash,
        Effect::JointElasticity,
    ],
    friction: true,
    least_fraction: 0.06,
    needs: &[Need::Reversals],
    ..Info::NEW
};

/// Widths relative to the recorded range of the joint.
const WIDTHS: [f64; 7] = [3e-4, 1e-3, 3e-3, 8e-3, 0.02, 0.05, 0.12];

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let (low, high) = scene.scale.range[joint];
    let range = (high - low).max(1e-6);
    let amplitude = || Quantity::plain("hysteresis", "N·m", Some(joint));
    let single = |width: f64, column: Column| {
        Candidate::single(
            Effect::PreslidingHysteresis,
            joint,
            amplitude(),
            Bound::Positive,
            column,
        )
        .with_shape("width", width, "rad")
    };
    let mut all = Vec::new();
    let mut elements = Vec::new();
    for w in WIDTHS {
        let width = w * range;
        let (stop, dahl) = (
            Stop { width },
            Dahl {
                stiffness: 1.0 / width,
            },
        );
        let coulomb = || Term::Sliding(scene.coulomb(joint));
        let whole = |term: Term| Column::term(joint, term);
        // In place of the joint's Coulomb friction.
        let instead = |term: Term| Column::terms(joint, vec![(1.0, term), (-1.0, coulomb())]);
        all.push(single(width, whole(Term::Stop(stop))));
        all.push(single(width, whole(Term::Dahl(dahl))));
        all.push(single(width, instead(Term::Stop(stop))));
        all.push(single(width, instead(Term::Dahl(dahl))));
        // Micro-damping: the rate of the state, as bristles have it.
        let damping = Quantity::plain("micro_damping", "N·m·s", Some(joint));
        let damped = single(width, instead(Term::Dahl(dahl)));
        all.push(damped.and(damping, Bound::Free, whole(Term::DahlRate(dahl))));
        elements.push((width, instead(Term::Stop(stop))));
    }
    // A distribution of widths: three neighbouring elements at once.
    for three in elements.windows(3) {
        let mut c = single(three[0].0, three[0].1.clone());
        for (width, element) in &three[1..] {
            c = c
                .and(amplitude(), Bound::Free, element.clone())
                .with_shape("width", *width, "rad");
        }
        c.bounds = vec![Bound::Free; 3];
        all.push(c);
    }
    all
}
