//! Distribution of a link's inertia among the bodies that are fixed to each other in it.

use crate::robot::Inertia;

/// How often bodies are made lighter.
const HALVES: i32 = 30;

/// A body whose second moments are this far below zero, relative, is still a possible one.
const POSSIBLE: f64 = 1e-9;

/// Inertias, all in the link's frame, that together make `whole`: what the first of `bodies` has, and the part of theirs that
/// the others keep. The first has what the others leave; where that is no possible body the others are made lighter, by
/// halves, until it is, as simulators want mass in whatever moves.
pub(super) fn share(whole: &Inertia, others: &[Inertia]) -> (Inertia, f64) {
    let rest = |part: f64| {
        let parts = others.iter().map(|b| scaled(b, -part));
        parts.fold(*whole, |sum, part| sum.plus(&part))
    };
    let mut parts = (0..HALVES).map(|k| 0.5_f64.powi(k));
    let part = parts.find(|&s| rest(s).is_consistent(POSSIBLE));
    let part = part.unwrap_or(0.5_f64.powi(HALVES));
    (rest(part), part)
}

/// A body with all of its parameters times `factor`.
pub(super) fn scaled(body: &Inertia, factor: f64) -> Inertia {
    Inertia::from_parameters(&body.parameters().map(|v| v * factor))
}

/// Whether a link's parameters differ by more than rounding.
pub(super) fn departs(old: &Inertia, new: &Inertia) -> bool {
    /// Change of a link's parameters, relative to their size, that is rounding.
    const ROUNDING: f64 = 1e-12;
    let (old, new) = (old.parameters(), new.parameters());
    let size = |part: std::ops::Range<usize>| -> f64 {
        let largest = old[part.clone()].iter().chain(&new[part]);
        largest.fold(0.0, |m: f64, v| m.max(v.abs()))
    };
    let apart = |part: std::ops::Range<usize>| {
        let allowed = ROUNDING * size(part.clone());
        part.into_iter().any(|k| (old[k] - new[k]).abs() > allowed)
    };
    apart(0..1) || apart(1..4) || apart(4..10)
}
