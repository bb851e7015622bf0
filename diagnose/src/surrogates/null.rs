//! Null distribution of the search's gains: their size on surrogates without a further effect.

use super::scan::{Scan, scans};
use super::{Source, null_torque};
use crate::algebra::batched_trials::Fitted;
use crate::catalogue::effect::Effect;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;

/// Seed of the surrogates: it is fixed, so that a recording always has the same null distribution.
const SEED: u64 = 0x5EED;
/// Probability that defines the chance level of a gain.
const RARE: f64 = 0.01;
/// Number of surrogates that are in memory together.
const TOGETHER: u64 = 100;

/// Gains on surrogates, nats.
#[derive(Clone, Debug)]
pub struct Null {
    /// Largest gain of any cause beyond parameters, by surrogate. Parameters are left out, since they are right
    /// or wrong by themselves: in surrogates of a model whose friction was moved, the given friction is wrong.
    pub largest: Vec<f64>,
    /// Largest gain of each effect, by surrogate.
    pub by_effect: BTreeMap<Effect, Vec<f64>>,
}

impl Null {
    /// p-value of a gain: chance of one at least this large anywhere in the catalogue where nothing is missing.
    /// It is (1 + number of surrogates that reach it)/(1 + number of surrogates). None for parameters.
    pub fn p_value(&self, effect: Effect, gain: f64) -> Option<f64> {
        if effect.info().parameter {
            return None;
        }
        let reached = self.largest.iter().filter(|g| **g >= gain).count();
        Some((1 + reached) as f64 / (1 + self.largest.len()) as f64)
    }

    /// Chance level, nats: gain that chance reaches in one recording of a hundred.
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

impl Source<'_> {
    /// Null distribution beyond all accepted causes. A gain is that of a candidate's own columns, without other
    /// evidence. Each number of `surrogates` is another one.
    pub fn null(&self, surrogates: Range<u64>) -> Null {
        let (first, last) = (surrogates.start, surrogates.end);
        let parts = (first..last).step_by(TOGETHER as usize);
        let none = Null {
            largest: Vec::new(),
            by_effect: BTreeMap::new(),
        };
        let lines = self.lines();
        parts.fold(none, |null, start| {
            null.and(self.gains(&lines, start..(start + TOGETHER).min(last)))
        })
    }

    /// Scans for periodic lines over position of all joints.
    fn lines(&self) -> Vec<Scan> {
        let (frame, scale) = (&self.frames.data, &self.frames.scale);
        (0..frame.dof())
            .into_par_iter()
            .flat_map(|j| scans(frame, scale, j, self.residual, self.weight, self.cut))
            .collect()
    }

    /// J of a fit to each surrogate, nats.
    pub(super) fn values(&self, fitted: &Fitted) -> Vec<f64> {
        let each = fitted.error.columns().into_iter().zip(&fitted.penalty);
        each.map(|(e, p)| self.search.objective.value(&e.to_vec(), *p, 0))
            .collect()
    }

    /// Gains of each candidate and each scan on the surrogates with the given numbers, nats.
    fn gains(&self, lines: &[Scan], numbers: Range<u64>) -> Null {
        let drawn = null_torque::draw(self.fit, self.stretches.fold.len(), SEED, numbers);
        let fitted = Fitted::new(self.fit, &drawn.products(self.fit, &self.stretches));
        let before = self.values(&fitted);
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
        let lines = lines.par_iter().map(|scan| {
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
