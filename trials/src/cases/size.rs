//! Whether withheld effects came out as large as they were meant.

use super::experiment::{Chosen, Run};
use super::oracle::{low_passed, rms};
use std::ops::Range;

/// Frequency up to which the torque of effects that vibrate counts, Hz.
const VIBRATION: f64 = 20.0;
/// Smallest part of a joint's torque, and largest, that an effect may make.
const SHARES: Range<f64> = 0.03..0.6;
/// Number of simulations of a case in which the sizes of its effects are set.
pub const ROUNDS: usize = 3;

/// Result of setting the sizes of a case's effects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sized {
    /// The sizes are near enough to the intended ones.
    Well,
    /// The sizes were corrected, and the case is to be simulated again.
    Again,
    /// The intended sizes cannot be reached with this case.
    Unsuited,
}

/// Root mean square of each column of a table with `n` of them.
pub fn column_rms(table: &[f64], n: usize) -> Vec<f64> {
    (0..n)
        .map(|j| rms(table.iter().skip(j).step_by(n).copied()))
        .collect()
}

/// Torques of the effects, low-passed for those that vibrate.
pub fn without_vibration(
    mut found: Vec<Vec<f64>>,
    withheld: &[Chosen],
    run: &Run,
    rate: f64,
) -> Vec<Vec<f64>> {
    let vibrating = found
        .iter_mut()
        .zip(withheld)
        .filter(|(_, w)| w.effect.vibrates());
    for (e, _) in vibrating {
        *e = low_passed(e, &run.trace.bounds(), run.trace.dof, rate, VIBRATION);
    }
    found
}

/// Part of its joint's torque that each effect makes.
pub fn shares(withheld: &[Chosen], found: &[Vec<f64>], run: &Run) -> Vec<f64> {
    let n = run.trace.dof;
    let torque = column_rms(&run.noted, n);
    withheld
        .iter()
        .zip(found)
        .map(|(w, e)| column_rms(e, n)[w.at] / torque[w.at])
        .collect()
}

/// Corrects sizes after a round in which the effects came out with these shares.
pub fn sized(withheld: &mut [Chosen], shares: &[f64], round: usize) -> Sized {
    let wrong = withheld
        .iter()
        .zip(shares)
        .any(|(w, s)| !(0.55..1.8).contains(&(s / w.share)));
    if wrong && round + 1 < ROUNDS {
        for (w, s) in withheld.iter_mut().zip(shares) {
            w.size = (w.size * (w.share / s).clamp(0.2, 4.0)).min(w.effect.largest());
        }
        return Sized::Again;
    }
    if shares.iter().any(|s| !SHARES.contains(s)) {
        Sized::Unsuited
    } else {
        Sized::Well
    }
}
