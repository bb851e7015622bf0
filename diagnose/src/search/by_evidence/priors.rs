//! Priors of the hypotheses: odds of an effect at its places, and sizes of its torque.

use super::posterior::{Group, ODDS};
use crate::algebra::cholesky::Cholesky;
use crate::catalogue::effect::Effect;
use crate::catalogue::{Bound, Candidate};
use crate::search::model_comparison::Simplest;
use crate::search::select::{MOMENTS, Search};
use ::evidence::{Family, Hypothesis};
use ndarray::{Array1, Array2};
use rayon::prelude::*;
use std::collections::HashMap;

/// Root mean square of a small torque over the joint's torque: one deviation of its prior.
const SMALL: f64 = 0.01;
/// Root mean square of a cause's torque over the joint's torque: one deviation of its prior.
const LARGE: f64 = 0.3;
/// Ridge of the fit of parameters to a candidate's columns, relative.
const ABSORBED: f64 = 1e-3;

/// Size of a hypothesis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Size {
    /// Torque of which every robot has a little: it is no cause.
    Small = 0,
    /// Torque that is a cause.
    Large = 1,
}

/// Priors of each candidate's coefficients, by [`Size`]; none where the candidate cannot have that size.
pub(super) fn groups(
    simplest: &Simplest,
    search: &Search,
    torque: &[f64],
) -> Vec<[Option<Group>; 2]> {
    let base = simplest.objective.base(simplest.model, 1.0).len();
    let all = (0..simplest.candidates.len()).into_par_iter();
    all.map(|candidate| {
        let columns = &simplest.members[candidate];
        let own = &simplest.candidates[candidate];
        let absorbable = own.effect.info().absorbable;
        let square = || mean_square(simplest, columns, base, torque, absorbable);
        let corrected = own.bounds.iter().any(|b| matches!(b, Bound::Between(..)));
        if own.known.is_some() || columns.iter().any(|c| *c < base) {
            [None, Some(stated(simplest, search, candidate))]
        } else if corrected {
            // A coefficient near one: the shape alone says how large the torque is.
            let group = Some(stated(simplest, search, candidate));
            let small = square().sum() * (SMALL.powi(-2) - LARGE.powi(-2));
            if 0.5 * small < (LARGE / SMALL).ln() {
                [group, None]
            } else {
                [None, group]
            }
        } else {
            let mut square = square() * columns.len() as f64;
            // Columns that coincide share their torque.
            let least = square.diag().iter().fold(0.0, |m: f64, d| m.max(*d)) * 1e-6 + 1e-12;
            square.diag_mut().mapv_inplace(|d| d + least);
            let sized = |size: f64| Group::new(columns.clone(), 0.0, &square / (size * size));
            [Some(sized(SMALL)), Some(sized(LARGE))]
        }
    })
    .collect()
}

/// Prior that the search by rules has, too. The weight and the moments of a body on the last link are those of a cause.
fn stated(simplest: &Simplest, search: &Search, candidate: usize) -> Group {
    let own = search.variables(candidate);
    let body = simplest.candidates[candidate].effect == Effect::Payload;
    let tighter = (simplest.objective.settings.wide / LARGE).powi(2);
    let each = own.iter().enumerate().map(|(p, v)| {
        let factor = if body && p < MOMENTS { tighter } else { 1.0 };
        v.precision * factor
    });
    let precision = Array2::from_diag(&each.collect::<Array1<f64>>());
    Group::new(simplest.members[candidate].clone(), own[0].mean, precision)
}

/// Mean square of the torque of some columns with unit coefficients, relative to each joint's torque, as a matrix of their
/// products. Of torque that the parameters can take up in part, the rest counts.
fn mean_square(
    simplest: &Simplest,
    columns: &[usize],
    base: usize,
    torque: &[f64],
    absorbable: bool,
) -> Array2<f64> {
    let grams = simplest.objective.grams;
    let mut square = Array2::<f64>::zeros((columns.len(), columns.len()));
    let mut joints: f64 = 0.0;
    for (j, gram) in grams.total.iter().enumerate() {
        let place = |c: &usize| grams.layout.position(j, *c);
        let own: Vec<Option<usize>> = columns.iter().map(place).collect();
        if own.iter().all(Option::is_none) || gram.samples == 0.0 {
            continue;
        }
        joints += 1.0;
        let products = |rows: &[Option<usize>], columns: &[Option<usize>]| {
            Array2::from_shape_fn((rows.len(), columns.len()), |(a, b)| {
                match (rows[a], columns[b]) {
                    (Some(p), Some(r)) => gram.xx[[p, r]],
                    _ => 0.0,
                }
            })
        };
        let mut left = products(&own, &own);
        if !absorbable {
            let parameters: Vec<Option<usize>> = (0..base).map(|c| place(&c)).collect();
            let parameters: Vec<Option<usize>> =
                parameters.into_iter().filter(Option::is_some).collect();
            let cross = products(&own, &parameters);
            let factor = Cholesky::raised(products(&parameters, &parameters), ABSORBED);
            left -= &factor.solve_rows(&cross).dot(&cross.t());
        }
        square += &(left / (gram.samples * torque[j] * torque[j]));
    }
    square / joints.max(1.0)
}

/// Places of the candidates.
pub(super) struct Places {
    /// Hypothesis of each candidate; its only parameter is the number of its place.
    pub hypotheses: Vec<Hypothesis>,
    /// Family of each effect.
    pub families: Vec<Family>,
    /// Log prior of each candidate among the shapes of its place.
    pub shapes: Vec<f64>,
}

impl Places {
    /// Hypotheses of the candidates: each effect is a family, each place has one number.
    pub(super) fn new(candidates: &[Candidate]) -> Self {
        type Place = (Effect, Vec<usize>, Option<usize>);
        let mut places: HashMap<Place, usize> = HashMap::new();
        let mut effects: Vec<Effect> = Vec::new();
        let mut hypotheses = Vec::new();
        for c in candidates {
            let next = places.len();
            let place = *places
                .entry((c.effect, c.joints.clone(), c.driver))
                .or_insert(next);
            let known = effects.iter().position(|e| *e == c.effect);
            let family = known.unwrap_or_else(|| {
                effects.push(c.effect);
                effects.len() - 1
            });
            hypotheses.push(Hypothesis {
                parameters: vec![place],
                family,
            });
        }
        let families = effects.iter().map(|effect| Family {
            odds: ODDS,
            places: places.keys().filter(|(e, _, _)| e == effect).count(),
            independent: false,
        });
        let at = |h: &Hypothesis| {
            hypotheses
                .iter()
                .filter(|o| o.parameters == h.parameters)
                .count()
        };
        let shapes = hypotheses.iter().map(|h| -(at(h) as f64).ln()).collect();
        Self {
            families: families.collect(),
            shapes,
            hypotheses,
        }
    }
}
