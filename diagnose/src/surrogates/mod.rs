//! Surrogates of the user's own recording: torques as they would be if something were true of it.
//!
//! A surrogate's torque is what a fit predicts, its coefficients drawn from their posterior, plus what the accepted model
//! left of each stretch of time out of fold, with the stretch's sign drawn anew for all joints together (wild bootstrap by
//! blocks: Liu 1988; Shao 2010). Motion, places where the error is large, autocorrelation within a stretch and correlation between
//! joints stay; what repeats from stretch to stretch, and so could be a cause, goes. Only products with the torque change, so the
//! catalogue is searched on each surrogate by algebra. Lines over position, which are picked from the torque, are picked
//! again ([`scan`]).

mod naming;
mod null;
mod null_torque;
mod scan;
#[cfg(test)]
mod tests;

pub use naming::Naming;
pub use null::Null;

use crate::algebra::fit::Fit;
use crate::algebra::folds::Fold;
use crate::catalogue::effect::Effect;
use crate::input::frames::Frames;
use crate::ladder::out_of_fold::OutOfFold;
use crate::search::find::{Findings, gap};
use crate::search::objective::Objective;
use crate::search::select::Search;
use crate::search::tables::Stretches;
use crate::simulator::NominalModel;
use ndarray::Array2;
use std::collections::HashSet;
use std::ops::Range;
use std::sync::OnceLock;

/// Everything that surrogates of one recording are drawn from and searched with.
pub struct Source<'a> {
    frames: &'a Frames,
    search: Search<'a>,
    fit: &'a Fit<'a>,
    /// What the accepted model leaves out of fold, and the rows' weights, shape (rows, joints).
    residual: &'a Array2<f64>,
    weight: &'a Array2<f64>,
    /// Stretches of rows, each with its fold, and what is left on them.
    cut: &'a [(usize, Range<usize>)],
    stretches: Stretches,
    /// Candidates that are tried beside the accepted ones.
    open: Vec<usize>,
}

/// Calls `ask` with the source of surrogates of the fitted recording. Flat tops and blows that were seen stay candidates as they are.
pub fn with<T>(
    model: &NominalModel,
    frames: &Frames,
    found: &Findings,
    weight: &Array2<f64>,
    ask: impl FnOnce(&Source) -> T,
) -> T {
    let (frame, scale) = (&frames.data, &frames.scale);
    let objective = Objective::new(&found.grams, scale, &found.settings.search);
    let fit = found.tight_fit(scale);
    let gap = gap(model, frame, scale);
    let unseen = OutOfFold::new(found, frames, &gap, weight);
    let residual = frame.table_thin(&unseen.residual(&fit));
    let length = (found.settings.ladder.stretch * frame.row_rate()) as usize;
    let cut = stretches(frame.folds(), length.max(1));
    let accepted: Vec<usize> = found.accepted.iter().map(|a| a.candidate).collect();
    let search = Search {
        objective: &objective,
        candidates: &found.candidates,
        members: &found.dictionary.members,
        robot: model.sizes(),
        base: found.tight.0[..found.base].to_vec(),
        barred: HashSet::new(),
        chance: 0.0,
        missing: OnceLock::new(),
    };
    let scanned = |c: &usize| found.candidates[*c].effect != Effect::TorqueRipple;
    ask(&Source {
        frames,
        open: (0..found.candidates.len())
            .filter(|&c| search.open(c, &accepted))
            .filter(scanned)
            .collect(),
        search,
        fit: &fit,
        stretches: found
            .tables
            .by_stretch(&residual, weight, &cut, frame.folds()),
        residual: &residual,
        weight,
        cut: &cut,
    })
}

/// Stretches of about `length` rows, each with its fold.
fn stretches(folds: &[Fold], length: usize) -> Vec<(usize, Range<usize>)> {
    let cut = |(f, rows): (usize, &Range<usize>)| {
        let (start, all) = (rows.start, rows.len());
        let n = (all / length).max(1);
        (0..n).map(move |k| (f, start + k * all / n..start + (k + 1) * all / n))
    };
    let each = folds.iter().enumerate();
    let each = each.flat_map(|(f, fold)| fold.scored.iter().map(move |r| (f, r)));
    each.flat_map(cut).collect()
}
