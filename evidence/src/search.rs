//! Search over sets of hypotheses: add, drop and swap, one or a whole family, until no neighbour is more probable.

use crate::quadratic::{Prior, Quadratic};

/// A hypothesis: parameters that differ from their given values.
#[derive(Debug, Clone, PartialEq)]
pub struct Hypothesis {
    /// Indices of the parameters that it frees.
    pub parameters: Vec<usize>,
    /// Index of the family that it belongs to: the same mechanism at another place.
    pub family: usize,
}

/// A mechanism, which may act at several places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Family {
    /// Prior odds that it acts at all.
    pub odds: f64,
    /// Number of places where it can act.
    pub places: usize,
    /// Whether each place is independent of the others. Otherwise what acts at one place is likely to act at more: every
    /// number of places is as probable as every other, and so is every set of that many.
    pub independent: bool,
}

impl Family {
    /// Logarithm of the prior odds of acting at a set of `k` places.
    fn log_prior(&self, k: usize) -> f64 {
        if k == 0 {
            return 0.0;
        }
        if self.independent {
            return k as f64 * self.odds.ln();
        }
        // Binomial coefficient C(places, k).
        let sets: f64 = (0..k)
            .map(|i| ((self.places - i) as f64 / (i + 1) as f64).ln())
            .sum();
        self.odds.ln() - (self.places as f64).ln() - sets
    }
}

/// A hypothesis that could stand in another's place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swap {
    /// Index of the hypothesis outside of the set.
    pub other: usize,
    /// Posterior probability of the set with it in place of the listed one, relative to the set as it is.
    pub weight: f64,
}

/// Outcome of a decision between sets of hypotheses.
#[derive(Debug, Clone)]
pub struct Decision {
    /// The most probable set found, indices increasing.
    pub set: Vec<usize>,
    /// Posterior inclusion probability of each hypothesis, over the set and its neighbours.
    pub inclusion: Vec<f64>,
    /// For each member of the set (same order), what could stand in its place.
    pub swaps: Vec<Vec<Swap>>,
    /// Log posterior of the set, nats, up to a constant.
    pub log_posterior: f64,
}

/// Decides between all sets of `hypotheses`. `always` are parameters free under every one (their tolerance is given).
///
/// The neighbours of a set are those with one hypothesis more, less, or another in its place, and those with a family at all
/// of its places or at none. A set of n hypotheses among m has about n·m neighbours; each costs one Cholesky factor of what is
/// free.
pub fn decide(
    quadratic: &Quadratic,
    priors: &[Prior],
    always: &[usize],
    hypotheses: &[Hypothesis],
    families: &[Family],
    start: &[usize],
) -> Decision {
    let space = Space {
        quadratic,
        priors,
        always,
        hypotheses,
        families,
    };
    let (mut set, mut best) = space.possible_part(start);
    loop {
        let neighbours = space.neighbours(&set);
        let weighed = neighbours.into_iter().map(|s| (space.log_posterior(&s), s));
        match weighed.max_by(|a, b| a.0.total_cmp(&b.0)) {
            // Rounding alone must not keep the search going.
            Some((v, next)) if v > best + 1e-9 => (set, best) = (next, v),
            _ => return space.about(set, best),
        }
    }
}

/// What is decided where the set is settled by other means: inclusion over it and its neighbours, none of which counts for more
/// than the set itself.
pub fn about(
    quadratic: &Quadratic,
    priors: &[Prior],
    always: &[usize],
    hypotheses: &[Hypothesis],
    families: &[Family],
    set: &[usize],
) -> Decision {
    let space = Space {
        quadratic,
        priors,
        always,
        hypotheses,
        families,
    };
    let best = space.log_posterior(set);
    space.about(set.to_vec(), best)
}

/// Logarithm of the prior odds of a set.
pub fn log_prior(hypotheses: &[Hypothesis], families: &[Family], set: &[usize]) -> f64 {
    let acting = |f: usize| set.iter().filter(|&&h| hypotheses[h].family == f).count();
    families
        .iter()
        .enumerate()
        .map(|(f, own)| own.log_prior(acting(f)))
        .sum()
}

/// Sets of hypotheses among which is decided, and what weighs them.
struct Space<'a> {
    quadratic: &'a Quadratic,
    priors: &'a [Prior],
    always: &'a [usize],
    hypotheses: &'a [Hypothesis],
    families: &'a [Family],
}

impl Space<'_> {
    /// Log posterior of a set, or its positions that stand at their bounds with all that they free.
    fn value(&self, set: &[usize]) -> Result<f64, Vec<usize>> {
        let mut free: Vec<usize> = self.always.to_vec();
        for &h in set {
            free.extend(&self.hypotheses[h].parameters);
        }
        free.sort_unstable();
        free.dedup();
        let parameters = |&h: &usize| &self.hypotheses[h].parameters[..];
        let listed: Vec<&[usize]> = set.iter().map(parameters).collect();
        let prior = log_prior(self.hypotheses, self.families, set);
        possible(self.quadratic, self.priors, free, &listed).map(|log| log + prior)
    }

    fn log_posterior(&self, set: &[usize]) -> f64 {
        self.value(set).unwrap_or(f64::NEG_INFINITY)
    }

    /// The start without what stands at its bound: a neighbour may hold another such.
    fn possible_part(&self, start: &[usize]) -> (Vec<usize>, f64) {
        let mut set = start.to_vec();
        set.sort_unstable();
        loop {
            match self.value(&set) {
                Ok(best) => return (set, best),
                Err(idle) if idle.is_empty() => return (Vec::new(), self.log_posterior(&[])),
                Err(idle) => {
                    let kept = set.iter().enumerate().filter(|(k, _)| !idle.contains(k));
                    set = kept.map(|(_, &h)| h).collect();
                }
            }
        }
    }

    fn neighbours(&self, set: &[usize]) -> Vec<Vec<usize>> {
        let all: Vec<usize> = (0..self.hypotheses.len()).collect();
        let outside = || all.iter().filter(|&&h| !set.contains(&h));
        let mut out: Vec<Vec<usize>> = outside().map(|&h| with(set, h)).collect();
        for &gone in set {
            let rest = without(set, gone);
            out.extend(outside().map(|&h| with(&rest, h)));
            out.push(rest);
        }
        // One place more or less may be less probable where all or none are more so.
        for family in 0..self.families.len() {
            let own = |h: &usize| self.hypotheses[*h].family == family;
            let acting = set.iter().filter(|h| own(h)).count();
            let places = all.iter().filter(|h| own(h)).count();
            let others = set.iter().copied().filter(|h| !own(h));
            if acting > 1 {
                out.push(others.clone().collect());
            }
            if places - acting > 1 {
                let mut every: Vec<usize> = others.chain(all.iter().copied().filter(own)).collect();
                every.sort_unstable();
                out.push(every);
            }
        }
        out
    }

    /// Inclusion over a set of log posterior `best` and its neighbours.
    fn about(&self, set: Vec<usize>, best: f64) -> Decision {
        let mut total = 1.0;
        let mut inclusion = vec![0.0; self.hypotheses.len()];
        for &h in &set {
            inclusion[h] += 1.0;
        }
        let mut swaps = vec![Vec::new(); set.len()];
        for other in self.neighbours(&set) {
            let weight = (self.log_posterior(&other) - best).exp().min(1.0);
            total += weight;
            for &h in &other {
                inclusion[h] += weight;
            }
            let gone: Vec<usize> = (0..set.len())
                .filter(|&k| !other.contains(&set[k]))
                .collect();
            let came: Vec<usize> = other.iter().copied().filter(|h| !set.contains(h)).collect();
            if let ([gone], [came]) = (&gone[..], &came[..]) {
                swaps[*gone].push(Swap {
                    other: *came,
                    weight,
                });
            }
        }
        for p in &mut inclusion {
            *p /= total;
        }
        for list in &mut swaps {
            list.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        }
        Decision {
            set,
            inclusion,
            swaps,
            log_posterior: best,
        }
    }
}

/// Log evidence of what is free, where positive parameters stay so: one that the data draw below zero stands at zero. Where
/// that leaves hypotheses (their parameters in `listed`) with nothing, so that the set without them says the same, these; none
/// of them where the posterior is improper.
fn possible(
    quadratic: &Quadratic,
    priors: &[Prior],
    mut free: Vec<usize>,
    listed: &[&[usize]],
) -> Result<f64, Vec<usize>> {
    let mut priors = priors.to_vec();
    let bounded = |i: usize, priors: &[Prior]| {
        priors[i].positive && listed.iter().any(|own| own.contains(&i))
    };
    loop {
        let mode = quadratic.mode(&free, &priors).ok_or_else(Vec::new)?;
        let below: Vec<usize> = (0..free.len())
            .filter(|&r| bounded(free[r], &priors) && mode.x[r] < 0.0)
            .map(|r| free[r])
            .collect();
        if below.is_empty() {
            return Ok(mode.log_evidence);
        }
        free.retain(|i| !below.contains(i));
        for i in below {
            priors[i].mean = 0.0;
        }
        let idle: Vec<usize> = (0..listed.len())
            .filter(|&k| !listed[k].iter().any(|i| free.contains(i)))
            .collect();
        if !idle.is_empty() {
            return Err(idle);
        }
    }
}

fn with(set: &[usize], h: usize) -> Vec<usize> {
    let mut out = set.to_vec();
    out.push(h);
    out.sort_unstable();
    out
}

fn without(set: &[usize], h: usize) -> Vec<usize> {
    set.iter().copied().filter(|&k| k != h).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    fn simple(estimates: &[f64]) -> (Quadratic, Vec<Prior>, Vec<Hypothesis>, Vec<Family>) {
        let p = estimates.len();
        let quadratic = Quadratic {
            at: estimates.to_vec(),
            gradient: DVector::zeros(p),
            information: DMatrix::identity(p, p),
        };
        let priors = vec![
            Prior {
                mean: 0.0,
                deviation: 10.0,
                positive: false
            };
            p
        ];
        let hypotheses = (0..p)
            .map(|i| Hypothesis {
                parameters: vec![i],
                family: i,
            })
            .collect();
        let alone = Family {
            odds: 0.1,
            places: 1,
            independent: false,
        };
        (quadratic, priors, hypotheses, vec![alone; p])
    }

    #[test]
    fn what_is_many_deviations_away_is_named() {
        let (quadratic, priors, hypotheses, families) = simple(&[8.0, 0.5, -6.0]);
        let decision = decide(&quadratic, &priors, &[], &hypotheses, &families, &[]);
        assert_eq!(decision.set, [0, 2]);
        assert!(decision.inclusion[0] > 0.99 && decision.inclusion[1] < 0.05);
        // Odds of the second parameter by hand: prior 0.1, evidence ratio of N(0.5; 0, 101) to N(0.5; 0, 1).
        let log = -0.125 / 101.0 - 0.5 * (101.0f64).ln() + 0.125;
        let odds = 0.1 * log.exp();
        assert!((decision.inclusion[1] - odds / (1.0 + odds)).abs() < 1e-3);
    }

    #[test]
    fn what_cannot_be_told_apart_stands_in_its_place() {
        // Two parameters with the same effect on the data.
        let quadratic = Quadratic {
            at: vec![6.0, 0.0],
            gradient: DVector::zeros(2),
            information: DMatrix::from_element(2, 2, 1.0),
        };
        let (_, priors, hypotheses, families) = simple(&[0.0, 0.0]);
        let decision = decide(&quadratic, &priors, &[], &hypotheses, &families, &[]);
        assert_eq!(decision.set.len(), 1);
        assert!((decision.swaps[0][0].weight - 1.0).abs() < 1e-9);
        assert!(decision.inclusion.iter().all(|p| (p - 0.5).abs() < 0.05));
    }

    #[test]
    fn what_acts_everywhere_costs_less_than_as_many_accidents() {
        let shared = Family {
            odds: 0.1,
            places: 4,
            independent: false,
        };
        // All four places: 0.1 · 1/4 · 1; one place: 0.1 · 1/4 · 1/4.
        assert!((shared.log_prior(4) - (0.025f64).ln()).abs() < 1e-12);
        assert!((shared.log_prior(1) - (0.1f64 / 16.0).ln()).abs() < 1e-12);
        assert!((shared.log_prior(2) - (0.1f64 / 24.0).ln()).abs() < 1e-12);
        let apart = Family {
            independent: true,
            ..shared
        };
        assert!((apart.log_prior(4) - 4.0 * (0.1f64).ln()).abs() < 1e-12);
    }

    #[test]
    fn what_cannot_be_negative_is_no_explanation_below_zero() {
        let (quadratic, mut priors, hypotheses, families) = simple(&[-8.0]);
        let free = decide(&quadratic, &priors, &[], &hypotheses, &families, &[]);
        assert_eq!(free.set, [0]);
        priors[0].positive = true;
        let bounded = decide(&quadratic, &priors, &[], &hypotheses, &families, &[]);
        assert!(bounded.set.is_empty() && bounded.inclusion[0] == 0.0);
        // Two such at the start do not stand in the way of a third.
        let (quadratic, mut priors, hypotheses, families) = simple(&[-8.0, -7.0, 9.0]);
        priors.iter_mut().for_each(|p| p.positive = true);
        let all = decide(&quadratic, &priors, &[], &hypotheses, &families, &[0, 1]);
        assert_eq!(all.set, [2]);
        assert!(all.inclusion[2] > 0.99);
    }

    proptest! {
        /// Independent parameters are decided as if each stood alone.
        #[test]
        fn independent_hypotheses_do_not_disturb_each_other(values in prop::collection::vec(-8.0..8.0f64, 1..5)) {
            let (quadratic, priors, hypotheses, families) = simple(&values);
            let all = decide(&quadratic, &priors, &[], &hypotheses, &families, &[]);
            for (i, v) in values.iter().enumerate() {
                let (q, p, h, f) = simple(&[*v]);
                let alone = decide(&q, &p, &[], &h, &f, &[]);
                prop_assert_eq!(all.set.contains(&i), alone.set.contains(&0));
            }
        }
    }
}
