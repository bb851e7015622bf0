//! Where the fit of a set starts from that of its neighbour.

use super::free::pinned;
use crate::arm::Arm;
use crate::fit::{Effort, Fitted, Free, objective};
use crate::given::Given;
use crate::parameter::Parameter;
use crate::simulate::Track;
use nalgebra::{DMatrix, DVector};

/// Arm from which a fit of `free` starts, after the fit of `all`. What is not free has its given value. What stays free
/// is as it was, or moved as the fit's expansion says, whichever has the lower objective.
pub(super) fn start(
    given: &Given,
    fitted: &Fitted,
    all: &[Free],
    free: &[Free],
    blocks: &[Track],
    effort: Effort,
) -> Arm {
    let start = pinned(given, &fitted.arm, free);
    let Some(other) = moved(&start, fitted, all, free) else {
        return start;
    };
    let value = |arm: &Arm| {
        let mut arm = arm.clone();
        arm.step = effort.step;
        objective(&arm, free, blocks, &fitted.noise).unwrap_or(f64::INFINITY)
    };
    if value(&other) < value(&start) {
        other
    } else {
        start
    }
}

/// Arm `start`, in which some parameters of a fit were set to other values, with all others at the optimum that the fit's
/// expansion then has. None where it has none.
fn moved(start: &Arm, fitted: &Fitted, all: &[Free], free: &[Free]) -> Option<Arm> {
    let shift: Vec<f64> = all
        .iter()
        .zip(&fitted.x)
        .map(|(f, x)| f.coordinate(start.get(f.parameter)) - x)
        .collect();
    let stays = |i: &usize| {
        let own = free.iter().find(|f| f.parameter == all[*i].parameter);
        shift[*i] == 0.0 && own.is_some()
    };
    let (kept, gone): (Vec<usize>, Vec<usize>) = (0..all.len()).partition(stays);
    let information = &fitted.information;
    let mut a = DMatrix::from_fn(kept.len(), kept.len(), |r, c| {
        information[(kept[r], kept[c])]
    });
    let mut b = DVector::from_iterator(
        kept.len(),
        kept.iter().map(|&i| {
            -gone
                .iter()
                .map(|&k| information[(i, k)] * shift[k])
                .sum::<f64>()
        }),
    );
    // The fit's own priors were in balance with the likelihood; those of the new fit take their place.
    let pull = |prior: Option<(f64, f64)>, x: f64| prior.map_or(0.0, |p| (x - p.0) / p.1.powi(2));
    for (r, &i) in kept.iter().enumerate() {
        let own = free.iter().find(|f| f.parameter == all[i].parameter)?;
        a[(r, r)] += own.prior.map_or(0.0, |p| p.1.powi(-2));
        b[r] -= pull(own.prior, fitted.x[i]) - pull(all[i].prior, fitted.x[i]);
    }
    let change = a.cholesky()?.solve(&b);
    let values: Vec<(Parameter, f64)> = kept
        .iter()
        .zip(change.iter())
        .map(|(&i, d)| (all[i].parameter, all[i].value(fitted.x[i] + d)))
        .collect();
    let mut out = start.clone();
    out.set(&values).ok()?;
    Some(out)
}
