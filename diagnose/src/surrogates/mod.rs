//! What the search would gain if nothing were missing: surrogates of the user's own recording.
//!
//! A surrogate's torque is what the accepted model predicts, its coefficients drawn from their posterior, plus what that model
//! left of each stretch of time out of fold, with the stretch's sign drawn anew for all joints together (wild bootstrap by
//! blocks: Liu 1988; Shao 2010). Motion, places where the error is large, autocorrelation within a stretch and correlation between
//! joints stay; what repeats from stretch to stretch, and so could be a cause, goes. Only products with the torque change, so the
//! whole catalogue is searched on each surrogate by algebra. Lines over position, which are picked from the torque, are picked
//! again ([`scan`]).

mod drawn;
mod scan;
#[cfg(test)]
mod tests;

use crate::algebra::fit::Fit;
use crate::algebra::folds::folds;
use crate::algebra::many::Fitted;
use crate::catalogue::effect::Effect;
use crate::input::frames::Frames;
use crate::ladder::out_of_fold::OutOfFold;
use crate::motion::scene::Scene;
use crate::search::dictionary::Stretches;
use crate::search::find::{Findings, gap};
use crate::search::objective::Objective;
use crate::search::select::Search;
use crate::simulator::NominalModel;
use ndarray::Array2;
use rayon::prelude::*;
use scan::{Scan, scans};
use std::collections::{BTreeMap, HashSet};
use std::ops::Range;

/// Chance below which a gain is none.
const RARE: f64 = 0.01;
/// Surrogates that are in memory together.
const TOGETHER: u64 = 100;

/// Gains on surrogates, nats.
#[derive(Clone, Debug)]
pub struct Null {
    /// Largest of any cause beyond parameters, surrogate by surrogate. Parameters are right or wrong by themselves: a surrogate of
    /// a model whose friction was moved is one whose given friction is wrong.
    pub largest: Vec<f64>,
    /// Largest of each effect.
    pub by_effect: BTreeMap<Effect, Vec<f64>>,
}

impl Null {
    /// Chance of a gain at least this large anywhere in the catalogue where nothing is missing: (1 + number of surrogates that
    /// reach it)/(1 + number of surrogates). None for parameters.
    pub fn p_value(&self, effect: Effect, gain: f64) -> Option<f64> {
        if effect.info().parameter {
            return None;
        }
        let reached = self.largest.iter().filter(|g| **g >= gain).count();
        Some((1 + reached) as f64 / (1 + self.largest.len()) as f64)
    }

    /// Gain that chance reaches in one recording of a hundred.
    pub fn level(&self) -> f64 {
        let mut sorted = self.largest.clone();
        sorted.sort_by(|a, b| b.total_cmp(a));
        let rare = ((self.largest.len() + 1) as f64 * RARE) as usize;
        sorted.get(rare.max(1) - 1).copied().unwrap_or(0.0)
    }

    fn and(mut self, other: Self) -> Self {
        self.largest.extend(other.largest);
        for (effect, gains) in other.by_effect {
            self.by_effect.entry(effect).or_default().extend(gains);
        }
        self
    }
}

/// Draws the null beyond everything that was found. A gain is what a candidate's own columns earn, without what else speaks for it.
/// Flat tops and blows that were seen stay candidates as they are. Each number of `surrogates` is another one.
pub fn draw(
    model: &NominalModel,
    frames: &Frames,
    found: &Findings,
    weight: &Array2<f64>,
    surrogates: Range<u64>,
) -> Null {
    let (frame, scale) = (&frames.data, &frames.scale);
    let objective = Objective::new(&found.grams, scale, &found.settings.search);
    let fit = found.tight_fit(scale);
    let scene = Scene::new(&found.present, frames.passage(), scale).with_tangents();
    let gap = gap(model, frame, scale);
    let unseen = OutOfFold::new(found, frames, &gap, weight);
    let residual = frame.table_thin(&unseen.residual(&fit));
    let length = (found.settings.ladder.stretch * frame.row_rate()) as usize;
    let cut = stretches(&folds(&frame.rows), length.max(1));
    let accepted: Vec<usize> = found.accepted.iter().map(|a| a.candidate).collect();
    let search = Search {
        objective: &objective,
        candidates: &found.candidates,
        members: &found.dictionary.members,
        robot: model.sizes(),
        base: found.tight.0[..found.base].to_vec(),
        barred: HashSet::new(),
        chance: 0.0,
    };
    let scanned = |c: &usize| found.candidates[*c].effect != Effect::TorqueRipple;
    let source = Source {
        open: (0..found.candidates.len())
            .filter(|&c| search.open(c, &accepted))
            .filter(scanned)
            .collect(),
        search,
        fit: &fit,
        stretches: found
            .dictionary
            .by_stretch(&scene, frame, &residual, weight, &cut),
        scans: (0..frame.dof())
            .into_par_iter()
            .flat_map(|j| scans(frame, scale, j, &residual, weight, &cut))
            .collect(),
    };
    let (first, last) = (surrogates.start, surrogates.end);
    let parts = (first..last).step_by(TOGETHER as usize);
    let none = Null {
        largest: Vec::new(),
        by_effect: BTreeMap::new(),
    };
    parts.fold(none, |null, start| {
        null.and(source.gains(start..(start + TOGETHER).min(last)))
    })
}

/// Stretches of about `length` rows, each with its fold.
fn stretches(folds: &[Vec<Range<usize>>], length: usize) -> Vec<(usize, Range<usize>)> {
    let cut = |(f, rows): (usize, &Range<usize>)| {
        let (start, all) = (rows.start, rows.len());
        let n = (all / length).max(1);
        (0..n).map(move |k| (f, start + k * all / n..start + (k + 1) * all / n))
    };
    let each = folds.iter().enumerate();
    let each = each.flat_map(|(f, ranges)| ranges.iter().map(move |r| (f, r)));
    each.flat_map(cut).collect()
}

/// Everything that surrogates of one recording are drawn from and searched with.
struct Source<'a> {
    search: Search<'a>,
    fit: &'a Fit<'a>,
    stretches: Stretches,
    scans: Vec<Scan>,
    /// Candidates that are tried.
    open: Vec<usize>,
}

impl Source<'_> {
    /// Gains on the surrogates with the given numbers: of each candidate and of each scan.
    fn gains(&self, numbers: Range<u64>) -> Null {
        let drawn = drawn::draw(self.fit, self.stretches.fold.len(), numbers);
        let fitted = Fitted::new(self.fit, &drawn.products(self.fit, &self.stretches));
        let before: Vec<f64> = fitted
            .error
            .columns()
            .into_iter()
            .zip(&fitted.penalty)
            .map(|(e, p)| self.search.objective.value(&e.to_vec(), *p, 0))
            .collect();
        let places = self.search.places();
        let tried = self.open.par_iter().map(|&c| {
            let trials = fitted.trials(&self.search.variables(c));
            let each = before.iter().zip(&trials);
            let gains: Vec<f64> = each
                .map(|(b, t)| {
                    let gain = self.search.gain_among(c, *b, t, &places);
                    gain.map_or(f64::NEG_INFINITY, |g| {
                        g - self.search.candidates[c].evidence
                    })
                })
                .collect();
            (self.search.candidates[c].effect, gains)
        });
        let lines = self.scans.par_iter().map(|scan| {
            let removed = scan.largest(&drawn.signs);
            let gains = (0..fitted.torques()).map(|s| {
                let after = |j: usize, e: f64| {
                    if j == scan.joint {
                        (e - removed[s]).max(0.0)
                    } else {
                        e
                    }
                };
                let error = fitted.error.column(s).to_vec();
                let after: Vec<f64> = error
                    .iter()
                    .enumerate()
                    .map(|(j, &e)| after(j, e))
                    .collect();
                let value = |e: &[f64], n| self.search.objective.value(e, 0.0, n);
                value(&error, 0) - value(&after, 2) - (fitted.error.nrows() as f64).ln()
            });
            (scan.effect, gains.collect())
        });
        let all: Vec<(Effect, Vec<f64>)> = tried.chain(lines).collect();
        let none = || vec![f64::NEG_INFINITY; fitted.torques()];
        let mut null = Null {
            largest: none(),
            by_effect: BTreeMap::new(),
        };
        for (effect, gains) in all {
            let own = null.by_effect.entry(effect).or_insert_with(none);
            for (own, gain) in own.iter_mut().zip(&gains) {
                *own = own.max(*gain);
            }
            if !effect.info().parameter {
                for (largest, gain) in null.largest.iter_mut().zip(gains) {
                    *largest = largest.max(gain);
                }
            }
        }
        null
    }
}
