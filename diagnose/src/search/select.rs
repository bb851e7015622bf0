//! Forward selection of causes with a backward elimination.

use crate::algebra::fit::{Fit, Variable};
use crate::algebra::trial::{Scored, SharedColumns, Trial};
use crate::catalogue::effect::Effect;
use crate::catalogue::{Bound, Candidate};
use crate::search::objective::Objective;
use crate::settings::Rule;
use physics::robot::Robot;
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::sync::OnceLock;

/// Number of candidates that are scored on folds left out when an accepted cause may be exchanged for a better one.
/// They are the best on the fitted rows.
const CONTENDERS: usize = 40;

/// Number of candidates whose columns are prepared together: their tables stay in the cache.
const TOGETHER: usize = 16;

/// Number of a body's first parameters that are mass and first moments.
pub(super) const MOMENTS: usize = 4;

/// Score of a candidate that is added to a fit.
#[derive(Clone, Debug)]
pub struct CandidateScore {
    /// Index of the candidate in the catalogue.
    pub candidate: usize,
    /// Fall of the criterion J by the candidate, nats: the larger, the better.
    pub gain: f64,
    /// Leave-one-fold-out squared error of each joint with the candidate, (N·m)², summed over rows.
    pub error: Vec<f64>,
    /// Penalty Σ λ (β − m)² of the whole fit with the candidate.
    pub penalty: f64,
    /// Coefficients of the candidate in that fit.
    pub gamma: Vec<f64>,
}

/// Accepted causes and their fit.
pub struct Selection<'a> {
    /// Accepted candidates in the order of acceptance.
    pub accepted: Vec<usize>,
    /// Fit with all accepted candidates.
    pub fit: Fit<'a>,
}

/// Forward search for causes over one dictionary of columns.
pub struct Search<'a> {
    /// Criterion J by which causes are compared.
    pub objective: &'a Objective<'a>,
    /// Candidates of the catalogue.
    pub candidates: &'a [Candidate],
    /// Column numbers of each candidate.
    pub members: &'a [Vec<usize>],
    /// Robot with the parameters of the model as given.
    pub robot: &'a Robot,
    /// Base variables with their priors.
    pub base: Vec<Variable>,
    /// Candidates that must not be accepted.
    pub barred: HashSet<usize>,
    /// Gain that a cause reaches by chance on this recording, nats. Causes other than wrong parameters must exceed it.
    pub chance: f64,
    /// Squared error relative to the torque, summed over joints, of which a cause must explain a part. It is that of
    /// the gap as given or of the base fit's residual, whichever is less. Friction that the model lacks would otherwise
    /// make every cause's part small.
    pub missing: OnceLock<f64>,
}

impl<'a> Search<'a> {
    /// Whether a special rule is switched off.
    pub(super) fn off(&self, rule: Rule) -> bool {
        self.objective.settings.off.holds(rule)
    }

    /// Squared error of which a cause must explain a part; see the field `missing`.
    pub(super) fn missing(&self) -> f64 {
        *self.missing.get_or_init(|| {
            let sum = |relative: Vec<f64>| relative.iter().map(|r| r * r).sum::<f64>();
            let base = self.objective.relative(&self.fit(&[]).error());
            sum(self.objective.given()).min(sum(base))
        })
    }

    /// Variables of a candidate's columns, with wide priors, or with priors from what is known of its coefficients.
    pub fn variables(&self, candidate: usize) -> Vec<Variable> {
        let c = &self.candidates[candidate];
        let wide = self.members[candidate]
            .iter()
            .map(|&c| self.objective.wide(c));
        if let Some((mean, deviation)) = c.known {
            let known = |&column: &usize| Variable {
                column,
                precision: deviation.powi(-2),
                mean,
            };
            return self.members[candidate].iter().map(known).collect();
        }
        match c.effect {
            _ if self.off(Rule::LinkPriors) => wide.collect(),
            Effect::LinkParameters if c.change.is_some() && c.shape.is_empty() => {
                let precision = self.objective.settings.density.powi(-2);
                vec![Variable::about_zero(self.members[candidate][0], precision)]
            }
            Effect::LinkParameters if c.change.is_none() => {
                let mut freed = self.objective.freed_link(self.robot, c.joints[0]);
                freed.retain(|v| self.members[candidate].contains(&v.column));
                freed
            }
            Effect::Payload => wide
                .zip(self.objective.freed_link(self.robot, c.joints[0]))
                .enumerate()
                .map(|(p, (wide, freed))| if p < MOMENTS { wide } else { freed })
                .collect(),
            _ => wide.collect(),
        }
    }

    /// Fit of the base and the candidates `accepted`.
    pub fn fit(&self, accepted: &[usize]) -> Fit<'a> {
        let mut variables = self.base.clone();
        variables.extend(accepted.iter().flat_map(|&c| self.variables(c)));
        self.objective.fit(variables)
    }

    /// Number of coefficients that a candidate is charged for. A recording shows little more of a body on the last link
    /// than two moments about the last axis. Priors tie its other parameters. Wrong parameters of the last link have
    /// the same columns at the same price.
    fn price(&self, candidate: usize) -> usize {
        let c = &self.candidates[candidate];
        let all = self.members[candidate].len();
        let shown = self.objective.settings.last_link_price;
        match c.effect {
            // Candidates that a trace identifies are charged for none.
            _ if c.shown.is_some() => 0,
            _ if self.off(Rule::LastLink) => all,
            Effect::Payload => shown,
            Effect::LinkParameters if c.joints[0] + 1 == self.robot.dof() => shown.min(all),
            _ => all,
        }
    }

    /// Penalty of some causes in J, nats: for their coefficients, and for the number of places at which each effect was
    /// searched.
    pub fn charge(&self, accepted: &[usize]) -> f64 {
        let places = self.places();
        let each = accepted.iter().map(|&c| {
            let place = places[&self.candidates[c].effect].ln();
            place + self.objective.settings.cost * self.price(c) as f64
        });
        each.sum()
    }

    /// Number of accepted causes that are not wrong parameters.
    fn named(&self, accepted: &[usize]) -> usize {
        accepted
            .iter()
            .filter(|&&c| !self.candidates[c].effect.info().parameter)
            .count()
    }

    /// Scores of all admissible candidates on top of a fit, best first.
    pub fn tried(&self, fit: &Fit, accepted: &[usize]) -> Vec<CandidateScore> {
        let all: Vec<usize> = (0..self.candidates.len()).collect();
        self.judged(fit, accepted, &all, Scored::LeftOut)
    }

    /// Scores, on folds left out, of the candidates that are best on the fitted rows, and of `own` in any case. Best
    /// first.
    fn contenders(&self, fit: &Fit, accepted: &[usize], own: usize) -> Vec<CandidateScore> {
        let all: Vec<usize> = (0..self.candidates.len()).collect();
        let seen = self.judged(fit, accepted, &all, Scored::Fitted);
        let best = seen.iter().map(|t| t.candidate).filter(|c| *c != own);
        let few: Vec<usize> = best.take(CONTENDERS).chain([own]).collect();
        self.judged(fit, accepted, &few, Scored::LeftOut)
    }

    /// Scores of the admissible candidates among `some` on top of a fit, best first.
    fn judged(
        &self,
        fit: &Fit,
        accepted: &[usize],
        some: &[usize],
        scored: Scored,
    ) -> Vec<CandidateScore> {
        let before = self.objective.of_fit(fit, 0);
        let places = self.places();
        let open = some.iter().filter(|&&c| self.open(c, accepted));
        let open: Vec<usize> = open.copied().collect();
        let judge = |some: &[usize]| -> Vec<CandidateScore> {
            let columns: Vec<usize> = some.iter().flat_map(|&c| self.members[c].clone()).collect();
            let beside = SharedColumns::new(fit, &columns, scored);
            let score = |&c: &usize| {
                let trial = beside.trial(&self.variables(c));
                let gain = self.gain_among(c, before, &trial, &places)?;
                Some(CandidateScore {
                    candidate: c,
                    gain,
                    error: trial.error,
                    penalty: trial.penalty,
                    gamma: trial.gamma,
                })
            };
            some.iter().filter_map(score).collect()
        };
        let each = open.par_chunks(TOGETHER).flat_map_iter(judge);
        let mut all: Vec<CandidateScore> = each.collect();
        all.sort_by(|a, b| {
            b.gain
                .total_cmp(&a.gain)
                .then(a.candidate.cmp(&b.candidate))
        });
        all
    }

    /// Whether a candidate may be tried beside some accepted ones.
    pub fn open(&self, candidate: usize, accepted: &[usize]) -> bool {
        !self.barred.contains(&candidate) && !accepted.iter().any(|a| self.excludes(*a, candidate))
    }

    /// Fall of J by a candidate's trial, nats; none where its coefficients are out of bounds. `before` is J without it.
    /// The prior is equal for all effects, and for all `places` of one effect.
    pub fn gain_among(
        &self,
        candidate: usize,
        before: f64,
        trial: &Trial,
        places: &HashMap<Effect, f64>,
    ) -> Option<f64> {
        let c = &self.candidates[candidate];
        let most = self.objective.settings.most_change;
        let sensible = trial.gamma.iter().zip(&c.bounds);
        let mut sensible = sensible.map(|(g, b)| allowed(*g, *b));
        let link = c.effect == Effect::LinkParameters && c.shape.is_empty();
        let moves_little = || {
            let variables = self.variables(candidate);
            let mut each = trial.gamma.iter().zip(&variables);
            each.all(|(g, v)| g * g * v.precision < most)
        };
        let gain = before - self.objective.of_trial(trial, self.price(candidate)) + c.evidence
            - places[&c.effect].ln();
        (sensible.all(|s| s) && (!link || moves_little())).then_some(gain)
    }

    /// Number of places at which the catalogue looks for each effect.
    pub fn places(&self) -> HashMap<Effect, f64> {
        let of = |c: &'a Candidate| (c.effect, &c.joints, c.driver);
        let places: HashSet<_> = self.candidates.iter().map(of).collect();
        let mut counts = HashMap::new();
        for (effect, _, _) in places {
            *counts.entry(effect).or_insert(0.0) += 1.0;
        }
        counts
    }

    /// Whether an accepted candidate excludes another one: the same effect at the same joints with the same driver.
    fn excludes(&self, accepted: usize, other: usize) -> bool {
        let (a, b) = (&self.candidates[accepted], &self.candidates[other]);
        a.effect == b.effect && a.joints == b.joints && a.driver == b.driver
    }

    /// Forward selection: adds the best candidate until none is worth it and exchanges earlier choices for
    /// better ones. Then drops causes that the others have made superfluous.
    pub fn run(&self) -> Selection<'a> {
        let most = self.objective.settings.most_causes;
        let mut accepted: Vec<usize> = Vec::new();
        let mut gains: Vec<f64> = Vec::new();
        let mut fit = self.fit(&accepted);
        loop {
            let tried = self.tried(&fit, &accepted);
            let best = tried
                .iter()
                .find(|t| {
                    self.worth(&fit, t, &accepted)
                        && (self.by_trace(t.candidate, &accepted)
                            || self.plain(&fit, t)
                            || t.gain > self.relative_price(&accepted, &gains, t.candidate))
                })
                .map(|t| (t.candidate, t.gain));
            match best {
                Some((candidate, gain)) if self.named(&accepted) < most => {
                    accepted.push(candidate);
                    gains.push(gain);
                    self.exchange(&mut accepted);
                    fit = self.fit(&accepted);
                }
                _ => break,
            }
        }
        self.drop_superfluous(&mut accepted);
        let fit = self.fit(&accepted);
        Selection { accepted, fit }
    }

    /// Alternatives of the accepted causes: for each, all candidates tried in its place with the others kept;
    /// and all candidates tried beside all of them. Best first.
    pub fn alternatives(
        &self,
        selection: &Selection,
    ) -> (Vec<Vec<CandidateScore>>, Vec<CandidateScore>) {
        let accepted = &selection.accepted;
        let instead = |i: usize| {
            let others = without(accepted, i);
            self.tried(&self.fit(&others), &others)
        };
        let steps = (0..accepted.len()).map(instead).collect();
        (steps, self.tried(&selection.fit, accepted))
    }

    /// Whether a candidate would be accepted beside the base alone.
    pub fn accepts(&self, candidate: usize) -> bool {
        let fit = self.fit(&[]);
        let tried = self.judged(&fit, &[], &[candidate], Scored::LeftOut);
        tried.first().is_some_and(|t| self.worth(&fit, t, &[]))
    }

    /// One round of exchange over all choices but the newest: each is replaced by a candidate that explains
    /// more in its place. Causes that a trace names are kept.
    fn exchange(&self, accepted: &mut [usize]) {
        let shown = |c: usize| self.candidates[c].shown.is_some();
        for i in 0..accepted.len().saturating_sub(1) {
            if shown(accepted[i]) {
                continue;
            }
            let others = without(accepted, i);
            let tried = self.contenders(&self.fit(&others), &others, accepted[i]);
            let own = tried
                .iter()
                .find(|t| t.candidate == accepted[i])
                .map_or(f64::NEG_INFINITY, |t| t.gain);
            if let Some(best) = tried
                .first()
                .filter(|t| t.gain > own + self.objective.settings.cost)
            {
                accepted[i] = best.candidate;
            }
        }
    }

    /// Drops accepted causes that are no longer worth it beside the others.
    fn drop_superfluous(&self, accepted: &mut Vec<usize>) {
        let mut i = 0;
        while i < accepted.len() {
            let others = without(accepted, i);
            let fit = self.fit(&others);
            let tried = self.judged(&fit, &others, &[accepted[i]], Scored::LeftOut);
            if tried.first().is_some_and(|t| self.worth(&fit, t, &others)) {
                i += 1;
            } else {
                accepted.remove(i);
            }
        }
    }
}

/// Accepted causes without the one at position `i`.
pub(crate) fn without(accepted: &[usize], i: usize) -> Vec<usize> {
    accepted
        .iter()
        .enumerate()
        .filter(|&(k, _)| k != i)
        .map(|(_, &c)| c)
        .collect()
}

/// Whether a coefficient is within its bound.
fn allowed(gamma: f64, bound: Bound) -> bool {
    match bound {
        Bound::Free => gamma.is_finite(),
        Bound::Positive => gamma > 0.0,
        Bound::Between(low, high) => gamma > low && gamma < high,
    }
}
