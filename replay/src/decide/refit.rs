//! Fit of another set of mechanisms, started from the fit of the found set.

use super::Found;
use super::free::{free, pinned, tolerated};
use crate::arm::Arm;
use crate::fit::{Effort, Free, descend, objective};
use crate::given::Given;
use crate::parameter::Parameter;
use crate::simulate::Unstable;
use crate::tracks::Replayed;
use nalgebra::{DMatrix, DVector};

/// Arm fitted with the mechanisms `set` instead of the found ones. Parameters that are not free in it have their given
/// values. The fit starts from the found fit's values, or from those that its expansion predicts, whichever has the
/// lower objective.
///
/// # Errors
/// Simulator that is unstable.
pub fn refit(
    given: &Given,
    replayed: &Replayed,
    found: &Found,
    set: &[usize],
    effort: Effort,
) -> Result<Arm, Unstable> {
    let always = tolerated(given, replayed);
    let free = free(given, &found.mechanisms, set, &always);
    let (blocks, noise) = (&replayed.blocks, &found.fitted.noise);
    let start = pinned(given, &found.fitted.arm, &free);
    let start = match moved(&start, found, &free) {
        Some(other) => {
            let value = |arm: &Arm| {
                let mut arm = arm.clone();
                arm.step = effort.step;
                objective(&arm, &free, blocks, noise).unwrap_or(f64::INFINITY)
            };
            if value(&other) < value(&start) {
                other
            } else {
                start
            }
        }
        None => start,
    };
    Ok(descend(&start, &free, blocks, noise, effort)?.0)
}

/// Arm `start` with its free parameters moved to the optimum of the found fit's expansion, given those that differ from
/// that fit. None where the expansion has no optimum.
pub(super) fn moved(start: &Arm, found: &Found, free: &[Free]) -> Option<Arm> {
    let all = &found.free;
    let shift: Vec<f64> = all
        .iter()
        .zip(&found.fitted.x)
        .map(|(f, x)| f.coordinate(start.get(f.parameter)) - x)
        .collect();
    let stays = |i: &usize| {
        let own = free.iter().find(|f| f.parameter == all[*i].parameter);
        shift[*i] == 0.0 && own.is_some()
    };
    let (kept, gone): (Vec<usize>, Vec<usize>) = (0..all.len()).partition(stays);
    let information = &found.fitted.information;
    let mut a = DMatrix::from_fn(kept.len(), kept.len(), |r, c| {
        information[(kept[r], kept[c])]
    });
    let b = DVector::from_iterator(
        kept.len(),
        kept.iter().map(|&i| {
            -gone
                .iter()
                .map(|&k| information[(i, k)] * shift[k])
                .sum::<f64>()
        }),
    );
    for (r, &i) in kept.iter().enumerate() {
        a[(r, r)] += all[i].prior.map_or(0.0, |p| p.1.powi(-2));
    }
    let change = a.cholesky()?.solve(&b);
    let values: Vec<(Parameter, f64)> = kept
        .iter()
        .zip(change.iter())
        .map(|(&i, d)| (all[i].parameter, all[i].value(found.fitted.x[i] + d)))
        .collect();
    let mut out = start.clone();
    out.set(&values).ok()?;
    Some(out)
}
