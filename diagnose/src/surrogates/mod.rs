//! Surrogates of the user's recording: simulated torques under a hypothesis on the recording.
//!
//! A surrogate's torque is a fit's prediction, its coefficients drawn from their posterior, plus the
//! out-of-fold residual of the accepted model, with one random sign per stretch of time for all joints (wild
//! bootstrap by blocks: Liu 1988; Shao 2010). It keeps the motion, the places of large errors, autocorrelation
//! within a stretch and correlation between joints. It destroys all that repeats from stretch to stretch, and
//! so could be a cause. Only products with the torque change, so the catalogue is searched on each surrogate by
//! algebra. Lines over position, which are picked from the torque, are picked again ([`scan`]).

mod null;
mod null_torque;
mod scan;
#[cfg(test)]
mod tests;

pub use null::Null;

use crate::algebra::fit::Fit;
use crate::algebra::folds::Fold;
use crate::catalogue::effect::Effect;
use crate::input::frames::Frames;
use crate::ladder::out_of_fold::OutOfFold;
use crate::motion::scene::Scene;
use crate::search::find::{Findings, gap};
use crate::search::objective::Objective;
use crate::search::products::{Rows, Stretches};
use crate::search::select::Search;
use crate::simulator::NominalModel;
use ndarray::Array2;
use std::collections::HashSet;
use std::ops::Range;
use std::sync::OnceLock;

/// Data from which surrogates of one recording are drawn, and with which they are searched.
pub struct Source<'a> {
    frames: &'a Frames,
    search: Search<'a>,
    fit: &'a Fit<'a>,
    /// Residual of the accepted model out of fold, N·m (N), shape (rows, joints).
    residual: &'a Array2<f64>,
    weight: &'a Array2<f64>,
    /// Stretches of rows, each with its fold, and the products with the residual on them.
    cut: &'a [(usize, Range<usize>)],
    stretches: Stretches,
    /// Candidates that are tried beside the accepted ones.
    open: Vec<usize>,
}

/// Calls `ask` with the source of surrogates of the fitted recording. Candidates from a flat top or blows in
/// the recording are kept as they are.
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
    let scene = Scene::new(&found.session.present, frames.passage(), scale);
    let rows = Rows {
        dictionary: &found.dictionary,
        scene: &scene,
        frame,
        weight,
        kept: Some(&found.session.kept),
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
        stretches: rows.by_stretch(&residual, &cut),
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
