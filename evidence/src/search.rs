//! Search for the set of hypotheses with the highest posterior probability.
//!
//! Each step adds, drops or swaps one hypothesis, or takes or drops a whole family. The search ends where no such
//! neighbour is more probable.

use crate::quadratic::{Prior, Quadratic};

/// Hypothesis that some parameters differ from their given values.
#[derive(Debug, Clone, PartialEq)]
pub struct Hypothesis {
    /// Indices of the parameters that the hypothesis frees.
    pub parameters: Vec<usize>,
    /// Index of the hypothesis's family. A family is one mechanism; its members are that mechanism at different places.
    pub family: usize,
}

/// Family of hypotheses: one mechanism, which may act at several places. It sets their prior odds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Family {
    /// Prior odds that the mechanism acts. They are for each place where `independent`, and for any place at all
    /// otherwise.
    pub odds: f64,
    /// Number of places at which the mechanism can act, which is the number of hypotheses of the family.
    pub places: usize,
    /// Whether places are independent in the prior. Otherwise the prior probability that k places act goes with 1/k, and all
    /// sets of k places share it alike.
    pub independent: bool,
}

impl Family {
    /// Natural logarithm of the prior odds of one set of `k` places of this family against the empty set; 0 where `k`
    /// is 0.
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
        let all: f64 = (1..=self.places).map(|i| 1.0 / i as f64).sum();
        self.odds.ln() - (k as f64).ln() - all.ln() - sets
    }
}

/// Alternative to one member of the found set: another hypothesis in its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swap {
    /// Index of the other hypothesis, which is not in the set.
    pub other: usize,
    /// Posterior probability of the set after the swap, divided by that of the set itself; at most 1.
    pub weight: f64,
}

/// Result of the search: the found set of hypotheses and how probable each hypothesis is.
#[derive(Debug, Clone)]
pub struct Decision {
    /// Indices of the hypotheses of the most probable set found, increasing.
    pub set: Vec<usize>,
    /// Posterior inclusion probability of each hypothesis, 0 to 1: average over the set and its neighbours, weighted by
    /// posterior.
    pub inclusion: Vec<f64>,
    /// Alternatives to each member of the set, in the order of `set`, most probable first.
    pub swaps: Vec<Vec<Swap>>,
    /// Log posterior of the set, nats: log evidence plus log prior odds, up to a constant.
    pub log_posterior: f64,
}

/// Natural logarithm of the prior odds of `set` against the empty set: the sum over all families.
pub fn log_prior(hypotheses: &[Hypothesis], families: &[Family], set: &[usize]) -> f64 {
    let acting = |f: usize| set.iter().filter(|&&h| hypotheses[h].family == f).count();
    families
        .iter()
        .enumerate()
        .map(|(f, own)| own.log_prior(acting(f)))
        .sum()
}

/// Problem of the search: the likelihood, the priors and the hypotheses that can be combined.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Quadratic expansion of the negative log likelihood in P parameters.
    quadratic: Quadratic,
    /// Prior of each of the P parameters.
    priors: Vec<Prior>,
    /// Indices of the parameters that are free under every set.
    always: Vec<usize>,
    /// Hypotheses that can be combined.
    hypotheses: Vec<Hypothesis>,
    /// Families to which the hypotheses belong by their index.
    families: Vec<Family>,
    /// Whether the data bear on each hypothesis; others are in no set that is searched.
    shown: Vec<bool>,
}

/// Information times prior variance from which on the posterior deviation is at most half of the prior's.
const HALVED: f64 = 3.0;

impl Problem {
    /// Problem with an expansion of the negative log likelihood in P parameters, their priors, the indices of those that are
    /// free under every set, and the hypotheses with their families.
    ///
    /// The data bear on a hypothesis where they could halve the prior deviation of at least one of its parameters, all others
    /// given. Elsewhere the prior alone would decide. It would say of a family that acts at one place that it acts at all.
    pub fn new(
        quadratic: Quadratic,
        priors: Vec<Prior>,
        always: Vec<usize>,
        hypotheses: Vec<Hypothesis>,
        families: Vec<Family>,
    ) -> Self {
        let halved =
            |&i: &usize| quadratic.information[(i, i)] * priors[i].deviation.powi(2) >= HALVED;
        let bears = |h: &Hypothesis| h.parameters.iter().any(halved);
        let shown = hypotheses.iter().map(bears).collect();
        Self {
            quadratic,
            priors,
            always,
            hypotheses,
            families,
            shown,
        }
    }

    /// Searches all sets of hypotheses for the most probable one, from the set `start` on.
    ///
    /// The neighbours of a set have one hypothesis more, less, or another in its place. Further neighbours have a family at
    /// all of its places or at none. A set of n hypotheses among m has about n·m neighbours. Each costs one Cholesky
    /// factorisation of its free parameters' precision.
    pub fn decide(&self, start: &[usize]) -> Decision {
        let (mut set, mut best) = self.possible_part(start);
        loop {
            match self
                .weighed_neighbours(&set)
                .max_by(|a, b| a.0.total_cmp(&b.0))
            {
                // Margin of 1e-9 nats: differences by rounding must not keep the search going.
                Some((v, next)) if v > best + 1e-9 => (set, best) = (next, v),
                _ => return self.decision(set, best),
            }
        }
    }

    /// Inclusion probabilities and alternatives about a `set` that was chosen by other means; nothing is searched. A
    /// neighbour more probable than the set counts only as much as the set.
    pub fn about(&self, set: &[usize]) -> Decision {
        self.decision(set.to_vec(), self.log_posterior(set))
    }

    /// Log posterior of each set, nats, up to one constant; −∞ where what a set frees stands at its bound.
    pub fn weigh(&self, sets: &[Vec<usize>]) -> Vec<f64> {
        sets.iter().map(|set| self.log_posterior(set)).collect()
    }

    /// Sets of one hypothesis, and of one family at all of its places, most probable first.
    pub fn simplest(&self) -> Vec<Vec<usize>> {
        let possible = self.weighed_neighbours(&[]).filter(|(v, _)| v.is_finite());
        let mut sets: Vec<(f64, Vec<usize>)> = possible.collect();
        sets.sort_by(|a, b| b.0.total_cmp(&a.0));
        sets.into_iter().map(|(_, set)| set).collect()
    }

    /// Neighbours of a set, each with its log posterior, nats.
    fn weighed_neighbours(&self, set: &[usize]) -> impl Iterator<Item = (f64, Vec<usize>)> {
        let neighbours = self.neighbours(set).into_iter();
        neighbours.map(|other| (self.log_posterior(&other), other))
    }

    /// Log posterior of a set, nats. An error lists positions in `set` of hypotheses whose parameters all stand at the
    /// bound zero; it is empty where the posterior is improper.
    fn value(&self, set: &[usize]) -> Result<f64, Vec<usize>> {
        let mut free: Vec<usize> = self.always.to_vec();
        for &h in set {
            free.extend(&self.hypotheses[h].parameters);
        }
        free.sort_unstable();
        free.dedup();
        let parameters = |&h: &usize| &self.hypotheses[h].parameters[..];
        let listed: Vec<&[usize]> = set.iter().map(parameters).collect();
        let prior = log_prior(&self.hypotheses, &self.families, set);
        possible(&self.quadratic, &self.priors, free, &listed).map(|log| log + prior)
    }

    /// Log posterior of a set, nats; −∞ where a hypothesis of it frees nothing or the posterior is improper.
    fn log_posterior(&self, set: &[usize]) -> f64 {
        self.value(set).unwrap_or(f64::NEG_INFINITY)
    }

    /// Largest part of `start` under which every hypothesis still frees something, with its log posterior. Hypotheses
    /// whose parameters all stand at the bound zero are dropped.
    fn possible_part(&self, start: &[usize]) -> (Vec<usize>, f64) {
        let shown = start.iter().copied().filter(|&h| self.shown[h]);
        let mut set: Vec<usize> = shown.collect();
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

    /// Neighbours of a set, each with increasing indices: those that [`Problem::decide`] compares with it.
    fn neighbours(&self, set: &[usize]) -> Vec<Vec<usize>> {
        let all: Vec<usize> = (0..self.hypotheses.len())
            .filter(|&h| self.shown[h])
            .collect();
        let outside = || all.iter().filter(|&&h| !set.contains(&h));
        let mut out: Vec<Vec<usize>> = outside().map(|&h| with(set, h)).collect();
        for &gone in set {
            let rest = without(set, gone);
            out.extend(outside().map(|&h| with(&rest, h)));
            out.push(rest);
        }
        // Families as a whole: one place more or less can be less probable although all places or none are more
        // probable.
        for family in 0..self.families.len() {
            let own = |h: &usize| self.hypotheses[*h].family == family;
            let acting = set.iter().filter(|h| own(h)).count();
            let places = all.iter().filter(|h| own(h)).count();
            let others = set.iter().copied().filter(|h| !own(h));
            if acting > 1 {
                out.push(others.clone().collect());
            }
            if places > acting + 1 {
                let mut every: Vec<usize> = others.chain(all.iter().copied().filter(own)).collect();
                every.sort_unstable();
                out.push(every);
            }
        }
        out
    }

    /// Decision about a set with log posterior `best`: inclusion probabilities and swaps from the set and its
    /// neighbours.
    fn decision(&self, set: Vec<usize>, best: f64) -> Decision {
        let mut total = 1.0;
        let mut inclusion = vec![0.0; self.hypotheses.len()];
        for &h in &set {
            inclusion[h] += 1.0;
        }
        let mut swaps: Vec<Vec<Swap>> = vec![Vec::new(); set.len()];
        let mut dropped = vec![0.0; set.len()];
        for (value, other) in self.weighed_neighbours(&set) {
            let weight = (value - best).exp().min(1.0);
            total += weight;
            for &h in &other {
                inclusion[h] += weight;
            }
            let gone: Vec<usize> = (0..set.len())
                .filter(|&k| !other.contains(&set[k]))
                .collect();
            if let (&[k], true) = (&gone[..], other.len() < set.len()) {
                dropped[k] = weight;
            }
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
        for (list, dropped) in swaps.iter_mut().zip(dropped) {
            // What adds nothing to the set without the member does not stand in its place.
            list.retain(|swap| swap.weight > dropped);
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

/// Log evidence, nats, of the model with the parameters `free`, where positive parameters stay at zero or above. A
/// positive parameter of a hypothesis whose posterior mean is negative is fixed at zero. `listed` holds each
/// hypothesis's parameters.
///
/// # Errors
/// Positions in `listed` of hypotheses whose parameters are all fixed; none of them where the posterior is improper.
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

/// Set with hypothesis `h` added, indices increasing.
fn with(set: &[usize], h: usize) -> Vec<usize> {
    let mut out = set.to_vec();
    out.push(h);
    out.sort_unstable();
    out
}

/// Set with hypothesis `h` removed.
fn without(set: &[usize], h: usize) -> Vec<usize> {
    set.iter().copied().filter(|&k| k != h).collect()
}

#[cfg(test)]
mod tests;
