//! Causes of a short recording: those that halve a joint's error on pieces left out of the fit, and its squared
//! error on every single piece.
//!
//! A few seconds hold too few independent samples for a gain in nats, and too few stretches for surrogates. An
//! effect that makes most of a joint's error still shows, in each second by a fit to the others.

use crate::algebra::fit::Fit;
use crate::algebra::trial::{Scored, SharedColumns};
use crate::catalogue::info::Need;
use crate::search::model_comparison::{Answer, Comparison, Simplest};
use crate::search::objective::Objective;
use crate::search::select::{CandidateScore, Search, Selection};
use crate::settings::LadderSettings;
use std::collections::HashSet;

/// Folds of each piece of a short recording. Consecutive folds are joined until a piece has about `least` rows; `rows`
/// has the number of each fold.
pub(super) fn pieces(rows: &[usize], least: f64) -> Vec<Vec<usize>> {
    let mut out: Vec<Vec<usize>> = Vec::new();
    let mut length = f64::INFINITY;
    for (fold, &rows) in rows.iter().enumerate() {
        match out.last_mut() {
            // Tolerance: cutting in time loses half a row of each fold.
            Some(last) if length + 0.5 * last.len() as f64 <= 0.95 * least => {
                last.push(fold);
                length += rows as f64;
            }
            _ => {
                out.push(vec![fold]);
                length = rows as f64;
            }
        }
    }
    out
}

impl<'a> Simplest<'a> {
    /// Answer with further candidates, each of which halves a joint's error on every piece. Parameters are left out,
    /// and so are effects that only a longer recording tells from parameters.
    pub fn halving(
        &self,
        answer: Answer<'a>,
        pieces: &[Vec<usize>],
        settings: &LadderSettings,
    ) -> Answer<'a> {
        let search = self.search(answer.base.clone(), HashSet::new());
        let mut accepted = answer.selection.accepted.clone();
        while let Some(more) = self.halves(&search, &accepted, pieces, settings) {
            accepted.push(more);
        }
        if accepted.len() == answer.selection.accepted.len() {
            return answer;
        }
        let selection = Selection {
            fit: search.fit(&accepted),
            accepted,
        };
        let (steps, rest) = search.alternatives(&selection);
        let mut against = answer.against;
        against.resize_with(selection.accepted.len(), Comparison::default);
        Answer {
            selection,
            steps,
            rest,
            base: answer.base,
            against,
        }
    }

    /// Best candidate that halves a joint's error beside the accepted causes; none where no candidate does.
    fn halves(
        &self,
        search: &Search,
        accepted: &[usize],
        pieces: &[Vec<usize>],
        settings: &LadderSettings,
    ) -> Option<usize> {
        let named = |c: &usize| !self.candidates[*c].effect.info().parameter;
        if accepted.iter().filter(|c| named(c)).count() >= self.objective.settings.most_causes {
            return None;
        }
        let fit = search.fit(accepted);
        let before: Vec<Vec<f64>> = fit.errors().map(<[f64]>::to_vec).collect();
        let before = by_piece(&before, pieces);
        let whole = fit.error();
        // Comparison with a free refit: the candidate must also halve the error that the refit leaves.
        let freedoms = self.objective.settings.freedoms;
        let refits = freedoms.map(|freedom| {
            let mut variables = self.objective.base(self.model, freedom);
            variables.extend(accepted.iter().flat_map(|&c| search.variables(c)));
            self.objective.fit(variables).error()
        });
        let refitted = |j: usize| refits.iter().map(|e| e[j]).fold(f64::INFINITY, f64::min);
        let tried: Vec<CandidateScore> = search
            .tried(&fit, accepted)
            .into_iter()
            .filter(|t| self.may(t.candidate) && self.visible(&fit, t))
            .collect();
        let columns: Vec<usize> = tried
            .iter()
            .flat_map(|t| self.members[t.candidate].clone())
            .collect();
        let beside = SharedColumns::new(&fit, &columns, Scored::LeftOut);
        let halves = |t: &&CandidateScore| {
            let after = by_piece(&beside.parts(&search.variables(t.candidate)), pieces);
            let on = |j: usize| {
                let mut each = after.iter().zip(&before);
                let halved = |(after, before): (&Vec<f64>, &Vec<f64>)| {
                    after[j] <= settings.on_every * before[j]
                };
                pieces.len() > 1
                    && each.all(halved)
                    && t.error[j] <= settings.halved * refitted(j).min(whole[j])
            };
            self.candidates[t.candidate].joints.iter().any(|&j| on(j))
        };
        tried.iter().find(halves).map(|t| t.candidate)
    }

    /// Whether a few seconds of recording are enough to tell a candidate from wrong parameters.
    fn may(&self, candidate: usize) -> bool {
        let info = self.candidates[candidate].effect.info();
        let long = [Need::Minute, Need::Reversals];
        !info.parameter && !info.absorbable && !info.needs.iter().any(|n| long.contains(n))
    }

    /// Whether a candidate removes a visible error on some joint.
    fn visible(&self, fit: &Fit, tried: &CandidateScore) -> bool {
        let objective: &Objective = self.objective;
        let before = objective.relative(&fit.error());
        let after = objective.relative(&tried.error);
        let least = objective.settings.visible.powi(2);
        before
            .iter()
            .zip(&after)
            .any(|(b, a)| b * b - a * a > least)
    }
}

/// Squared error of each piece and joint, from that of each fold and joint.
fn by_piece(errors: &[Vec<f64>], pieces: &[Vec<usize>]) -> Vec<Vec<f64>> {
    let of = |folds: &Vec<usize>| {
        let joints = errors.first().map_or(0, Vec::len);
        (0..joints)
            .map(|j| folds.iter().map(|&f| errors[f][j]).sum())
            .collect()
    };
    pieces.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::pieces;

    #[test]
    fn pieces_are_about_a_second() {
        // A trajectory of four seconds is cut in eight, four of a second stand for themselves.
        let eight = pieces(&[13, 12, 13, 12, 13, 12, 13, 12], 25.0);
        assert_eq!(eight, [[0, 1], [2, 3], [4, 5], [6, 7]]);
        assert_eq!(pieces(&[25, 24, 26, 25], 25.0).len(), 4);
        assert_eq!(pieces(&[50, 50], 25.0), [[0], [1]]);
    }
}
