//! Fits of what lies around the best set.

use super::effort::NEXT;
use super::expand::{family, kinds};
use super::visited::{Visited, largest};
use super::{Search, Weighed};
use crate::catalogue::Effect;
use crate::simulate::Unstable;

/// Largest number of rounds of fits around the best set.
const AROUND: usize = 2;
/// Number of exchanges that are fitted in each of them.
const EXCHANGES: usize = 4;

impl Search<'_> {
    /// Adds fits of what lies around the best set and is far from linear: without each effect, and with something unknown on
    /// the joint that is explained least, beside the named effects of that joint or in their place, and with exchanges. What
    /// cannot become as probable as the best is not fitted to its end. Returns those of the last round, with their log posteriors relative
    /// to the best.
    pub(super) fn around(
        &self,
        visited: &mut Vec<Visited>,
        stage: &mut impl FnMut(&str),
    ) -> Result<Vec<Weighed>, Unstable> {
        stage("fitting without each cause");
        let mut others = Vec::new();
        let best = visited.swap_remove(self.best(visited)?);
        let common = self.common(std::slice::from_ref(&best))?;
        visited.push(self.visit(best.set, &best.fitted.arm, &common, NEXT)?);
        for round in 0..AROUND {
            let best = self.best(visited)?;
            let mut sketches = Vec::new();
            let near = &visited[best];
            let least = self.value(near, &near.fitted.noise);
            let mut sets = self.dropped(near);
            sets.extend(self.unnamed(near));
            sets.extend(self.exchanged(near)?);
            for set in sets {
                sketches.extend(self.sketch(set, near, least).ok());
            }
            sketches.push(visited.swap_remove(best));
            let common = self.common(&sketches)?;
            let values = self.values(&sketches, &common);
            let next = largest(&values);
            let own = sketches.pop().expect("it was put there");
            visited.push(own);
            let moves = next < sketches.len();
            if moves {
                let (set, arm) = (sketches[next].set.clone(), &sketches[next].fitted.arm);
                visited.push(self.visit(set, arm, &common, NEXT)?);
            }
            if !moves || round + 1 == AROUND {
                let relative = values.iter().map(|v| v - values[next]);
                others = sketches.into_iter().zip(relative).collect();
                break;
            }
        }
        Ok(others)
    }

    /// Sets that a fit's set becomes without one of its effects, effect by effect.
    fn dropped(&self, fit: &Visited) -> Vec<Vec<usize>> {
        let set = &fit.set;
        let of = |m: usize| family(&self.mechanisms[m]);
        let mut kinds: Vec<(Effect, bool)> = set.iter().map(|&m| of(m)).collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds
            .into_iter()
            .map(|kind| set.iter().copied().filter(|&m| of(m) != kind).collect())
            .collect()
    }

    /// Sets with something unknown on the joint that a fit explains least: beside the named effects of that joint, and in
    /// their place.
    fn unnamed(&self, fit: &Visited) -> Vec<Vec<usize>> {
        let set = &fit.set;
        let Some(unknown) = self.unknown(fit).filter(|u| !set.contains(u)) else {
            return Vec::new();
        };
        let joint = self.mechanisms[unknown].joint;
        let elsewhere = |m: &usize| self.mechanisms[*m].joint != joint;
        let mut sets = Vec::new();
        for kept in [set.clone(), set.iter().copied().filter(elsewhere).collect()] {
            let mut with: Vec<usize> = kept;
            with.push(unknown);
            with.sort_unstable();
            sets.push(with);
        }
        sets.dedup();
        sets
    }

    /// Sets in which another effect, at one place or at all, stands in the place of one of the fit's. They are the
    /// likeliest by the expansion about the fit, because what explains the same in another way may be far from it.
    fn exchanged(&self, fit: &Visited) -> Result<Vec<Vec<usize>>, Unstable> {
        let kinds = kinds(&self.mechanisms);
        let of = |m: usize| family(&self.mechanisms[m]);
        let named = |m: &usize| self.mechanisms[*m].effect != Effect::Unknown;
        let all: Vec<usize> = (0..self.mechanisms.len()).filter(named).collect();
        let mut sets = Vec::new();
        for gone in &kinds {
            let rest: Vec<usize> = fit
                .set
                .iter()
                .copied()
                .filter(|&m| of(m) != *gone)
                .collect();
            if rest.len() == fit.set.len() {
                continue;
            }
            let outside = |m: &&usize| of(**m) != *gone && !rest.contains(m);
            let each = all.iter().filter(outside).map(|&m| vec![m]);
            let every = kinds.iter().map(|kind| {
                let own = all.iter().filter(outside).filter(|&&m| of(m) == *kind);
                own.copied().collect()
            });
            let every = every.filter(|own: &Vec<usize>| own.len() > 1);
            for come in each.chain(every) {
                let mut set: Vec<usize> = rest.iter().copied().chain(come).collect();
                set.sort_unstable();
                sets.push(set);
            }
        }
        let (arm, noises) = (&fit.fitted.arm, &fit.fitted.noise);
        let weights = self.expand(arm, noises, &fit.set)?.weigh(&sets);
        let mut order: Vec<usize> = (0..sets.len())
            .filter(|&k| weights[k].is_finite())
            .collect();
        order.sort_by(|&a, &b| weights[b].total_cmp(&weights[a]));
        order.truncate(EXCHANGES);
        Ok(order.into_iter().map(|k| sets[k].clone()).collect())
    }
}
