//! What the search would gain if nothing were missing: surrogates of the user's own recording.
//!
//! A surrogate's torque is what the accepted model predicts, its coefficients drawn from their posterior, plus what that model
//! left of each stretch of time out of fold, with the stretch's sign drawn anew for all joints together (wild bootstrap by
//! blocks: Liu 1988; Shao 2010). Motion, places where the error is large, autocorrelation within a stretch and correlation between
//! joints stay; what repeats from stretch to stretch, and so could be a cause, goes. Only products with the torque change, so the
//! whole catalogue is searched on each surrogate by algebra.

use crate::algebra::cholesky::Cholesky;
use crate::algebra::fit::Fit;
use crate::algebra::folds::folds;
use crate::algebra::many::{Many, RightHand};
use crate::catalogue::effect::Effect;
use crate::input::frames::Frames;
use crate::motion::frame::Frame;
use crate::motion::scene::Scene;
use crate::search::dictionary::Stretches;
use crate::search::find::{Findings, gap};
use crate::search::objective::Objective;
use crate::search::select::Search;
use crate::simulator::NominalModel;
use ndarray::{Array1, Array2};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// Seed of the surrogates: the same recording has the same null.
const SEED: u64 = 0x5EED;

/// Gains on surrogates, nats.
#[derive(Clone, Debug)]
pub struct Null {
    /// Largest anywhere in the catalogue, surrogate by surrogate.
    pub largest: Vec<f64>,
    /// Largest of each effect.
    pub by_effect: HashMap<Effect, Vec<f64>>,
}

impl Null {
    /// Chance of a gain at least this large anywhere in the catalogue where nothing is missing: (1 + number of surrogates that
    /// reach it)/(1 + number of surrogates).
    pub fn p_value(&self, gain: f64) -> f64 {
        let reached = self.largest.iter().filter(|g| **g >= gain).count();
        (1 + reached) as f64 / (1 + self.largest.len()) as f64
    }
}

/// Draws the null beyond everything that was found. Candidates that were picked by looking at the residual are left out, as
/// the looking is not repeated.
pub fn draw(
    model: &NominalModel,
    frames: &Frames,
    found: &Findings,
    weight: &Array2<f64>,
    surrogates: u64,
) -> Null {
    let (frame, scale) = (&frames.data, &frames.scale);
    let objective = Objective::new(&found.grams, scale, &found.settings.search);
    let fit = found.tight_fit(scale);
    let scene = Scene::new(&found.present, frames.passage(), scale).with_tangents();
    let y = frame.table_thin(&gap(model, frame, scale));
    let residual = y - out_of_fold(found, &scene, frame, &fit);
    let length = (found.settings.ladder.stretch * frame.row_rate()) as usize;
    let cut = stretches(&folds(&frame.rows), length.max(1));
    let products = found
        .dictionary
        .by_stretch(&scene, frame, &residual, weight, &cut);
    let search = Search {
        objective: &objective,
        candidates: &found.candidates,
        members: &found.dictionary.members,
        robot: model.sizes(),
        base: found.tight.0[..found.base].to_vec(),
        barred: HashSet::new(),
    };
    let accepted: Vec<usize> = found.accepted.iter().map(|a| a.candidate).collect();
    gains(
        &search,
        &fit,
        &accepted,
        &products,
        found.picked_from,
        surrogates,
    )
}

/// What the fits that left them out predict of the fitted rows, shape (rows, joints).
fn out_of_fold(found: &Findings, scene: &Scene, frame: &Frame, fit: &Fit) -> Array2<f64> {
    let mut ids: Vec<usize> = fit.variables.iter().map(|v| v.column).collect();
    ids.sort_unstable();
    ids.dedup();
    let columns: Vec<(usize, usize, Array1<f64>)> = found
        .dictionary
        .evaluate(scene, &ids)
        .into_par_iter()
        .map(|(c, j, fine)| (c, j, frame.reduce(&fine)))
        .collect();
    let mut out = Array2::zeros((frame.len(), frame.dof()));
    for (fold, beta) in folds(&frame.rows).iter().zip(fit.betas()) {
        let mut by_column = HashMap::new();
        for (v, b) in fit.variables.iter().zip(beta) {
            *by_column.entry(v.column).or_insert(0.0) += b;
        }
        for (c, j, values) in &columns {
            for rows in fold {
                for i in rows.clone() {
                    out[[i, *j]] += by_column[c] * values[i];
                }
            }
        }
    }
    out
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

/// Gains of the catalogue on surrogates.
fn gains(
    search: &Search,
    fit: &Fit,
    accepted: &[usize],
    stretches: &Stretches,
    picked_from: usize,
    surrogates: u64,
) -> Null {
    let open: Vec<usize> = (0..picked_from)
        .filter(|&c| search.open(c, accepted))
        .collect();
    let sets = open.iter().map(|&c| search.variables(c)).collect();
    let many = Many::new(fit, sets);
    let root = Cholesky::new(&fit.precision());
    let gains: Vec<Vec<(Effect, f64)>> = (0..surrogates)
        .into_par_iter()
        .map(|s| {
            let mut rng = ChaCha8Rng::seed_from_u64(SEED);
            rng.set_stream(s);
            let y = surrogate(fit, &root, stretches, &mut rng);
            let fitted = many.fitted(&y);
            let before = search.objective.value(&fitted.error, fitted.penalty, 0);
            let each = open.iter().enumerate().filter_map(|(i, &c)| {
                let trial = many.trial(i, &fitted);
                let gain = search.gain(c, before, &trial)?;
                Some((search.candidates[c].effect, gain))
            });
            each.collect()
        })
        .collect();
    let mut null = Null {
        largest: Vec::with_capacity(gains.len()),
        by_effect: HashMap::new(),
    };
    for (s, each) in gains.iter().enumerate() {
        let mut largest = f64::NEG_INFINITY;
        for &(effect, gain) in each {
            largest = largest.max(gain);
            let own = null.by_effect.entry(effect).or_default();
            own.resize(s + 1, f64::NEG_INFINITY);
            own[s] = own[s].max(gain);
        }
        null.largest.push(largest);
    }
    null
}

/// Products with the torque of one surrogate.
fn surrogate(fit: &Fit, root: &Cholesky, stretches: &Stretches, rng: &mut ChaCha8Rng) -> RightHand {
    let noise: Array1<f64> = (0..fit.variables.len())
        .map(|_| StandardNormal.sample(rng))
        .collect();
    let beta = fit.beta() + &root.draw(noise.view());
    let signs: Array1<f64> = (0..stretches.fold.len())
        .map(|_| if rng.random_bool(0.5) { 1.0 } else { -1.0 })
        .collect();
    let (folds, dof) = (fit.folds(), stretches.products.len());
    let of_fold = |f: usize| -> Array1<f64> {
        let own = stretches.fold.iter().zip(&signs);
        own.map(|(fold, s)| if *fold == f { *s } else { 0.0 })
            .collect()
    };
    let mut right = RightHand {
        xy: Vec::with_capacity(folds),
        yy: Vec::with_capacity(folds),
    };
    for f in 0..folds {
        let signs = of_fold(f);
        let (mut xy, mut yy) = (Vec::with_capacity(dof), Vec::with_capacity(dof));
        for j in 0..dof {
            let rest = stretches.products[j].dot(&signs);
            let x = fit.expanded(j, &beta);
            let modelled = fit.products(f, j).dot(&x);
            let squares: f64 = stretches
                .squares
                .column(j)
                .iter()
                .zip(&signs)
                .map(|(q, s)| q * s * s)
                .sum();
            yy.push(x.dot(&modelled) + 2.0 * x.dot(&rest) + squares);
            xy.push(modelled + rest);
        }
        right.xy.push(xy);
        right.yy.push(yy);
    }
    right
}
