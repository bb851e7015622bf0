//! Decision which effects the motion shows: fits, expansions of the likelihood about them, and posterior probabilities.

mod around;
mod begin;
mod cut;
mod effort;
mod expand;
mod free;
mod neighbour;
mod refit;
mod visited;

pub use effort::COARSE;
pub use evidence::tempered;
pub use free::{RELATIVE, STANDSTILL};
pub use refit::{named, refit, refit_finely};
pub use visited::SMALL;

use crate::arm::{Arm, STEP};
use crate::catalogue::{self, Effect, Mechanism, Sizes};
use crate::fit::{Effort, Fitted, Free, Noise, fit, noise, objective};
use crate::given::Given;
use crate::simulate::{Track, Unstable};
use crate::tracks::Replayed;
use effort::{LAST, SKETCH};
use evidence::Decision;
use expand::{Expanded, expand, families, hypotheses};
use free::{Entry, always, pinned};
use visited::{Visited, largest};

/// Result of the search: the most probable set of mechanisms, the fit with it, and signs of unknown torques.
#[derive(Debug, Clone)]
pub struct Found {
    /// All mechanisms that were compared. Other indices point into this list.
    pub mechanisms: Vec<Mechanism>,
    /// Most probable set of mechanisms, by index, with all inclusion probabilities and the alternatives to each member.
    pub decision: Decision,
    /// Fit in which the mechanisms of the set are free.
    pub fitted: Fitted,
    /// Free parameters of that fit, in the order of its coordinates.
    pub free: Vec<Free>,
    /// Sets around it that were fitted.
    pub around: Vec<Neighbour>,
}

/// A set that was fitted beside the best one.
#[derive(Debug, Clone)]
pub struct Neighbour {
    /// Its mechanisms, indices increasing.
    pub set: Vec<usize>,
    /// Its fit.
    pub arm: Arm,
    /// Its posterior probability relative to the best set's, at most 1.
    pub weight: f64,
}

impl Found {
    /// Joints on which something unknown is more probable than not, with its probability.
    pub fn unknown(&self) -> Vec<(usize, f64)> {
        let of = |&m: &usize| {
            let own = &self.mechanisms[m];
            let probability = self.decision.inclusion[m];
            let kept = own.effect == Effect::Unknown && probability >= 0.5;
            own.joint.filter(|_| kept).map(|j| (j, probability))
        };
        self.decision.set.iter().filter_map(of).collect()
    }

    /// The listed mechanisms that have a name.
    pub fn named(&self) -> Vec<usize> {
        let named = |m: &usize| self.mechanisms[*m].effect != Effect::Unknown;
        self.decision.set.iter().copied().filter(named).collect()
    }
}

/// Finds the set of effects that explains the motion of `replayed` best. `stage` is called with the name of each step.
///
/// # Errors
/// Simulator as given that is unstable.
pub fn find(
    given: &Given,
    replayed: &Replayed,
    mut stage: impl FnMut(&str),
) -> Result<Found, Unstable> {
    let sizes = Sizes::of(given, replayed);
    let mut given = given.clone();
    given.arm = sizes.scaled(&given.arm);
    let search = Search {
        mechanisms: catalogue::mechanisms(&given, replayed, &sizes),
        always: always(&given, &sizes),
        given: &given,
        replayed,
        floors: replayed
            .quantum
            .iter()
            .map(|q| (q * q / 12.0).max(1e-14))
            .collect(),
        // A quarter of a second, until a fit shows its own.
        correlation: (0.25 / sizes.period).max(1.0),
    };
    // From nothing but tolerances; where that does not explain the motion, from all that every servo has, too.
    let mut visited = search.bare(&mut stage)?;
    let few = &visited[search.best(&visited)?];
    if !few.explains(&replayed.tracking) {
        visited.extend(search.equipped(&mut stage)?);
    }
    let others = search.around(&mut visited, &mut stage)?;
    search.decide(visited, others, &mut stage)
}

/// A fitted set with its log posterior relative to that of the best, nats.
type Weighed = (Visited, f64);

/// What a search needs.
struct Search<'a> {
    given: &'a Given,
    replayed: &'a Replayed,
    mechanisms: Vec<Mechanism>,
    always: Vec<Entry>,
    floors: Vec<f64>,
    /// Samples that make an independent one, before a fit has shown them.
    correlation: f64,
}

impl Search<'_> {
    fn blocks(&self) -> &[Track] {
        &self.replayed.blocks
    }

    /// Noise before a fit has shown its own.
    fn first(&self) -> Vec<Noise> {
        let of = |&floor: &f64| Noise {
            floor,
            correlation: self.correlation,
        };
        self.floors.iter().map(of).collect()
    }

    fn free(&self, set: &[usize]) -> Vec<Free> {
        free::free(self.given, &self.mechanisms, set, &self.always)
    }

    /// Noise of the fit that leaves least: under it all sets are compared.
    fn common(&self, visited: &[Visited]) -> Result<Vec<Noise>, Unstable> {
        let first = self.first();
        let closest = visited
            .iter()
            .min_by(|a, b| a.misfit(&first).total_cmp(&b.misfit(&first)))
            .map_or(&self.given.arm, |v| &v.fitted.arm);
        noise(closest, self.blocks(), &self.floors)
    }

    /// Log posterior of each set at its own fit, nats, up to a constant.
    fn values(&self, visited: &[Visited], noises: &[Noise]) -> Vec<f64> {
        visited.iter().map(|v| self.value(v, noises)).collect()
    }

    fn value(&self, visited: &Visited, noises: &[Noise]) -> f64 {
        visited.log_evidence(noises) + self.log_prior(&visited.set)
    }

    fn log_prior(&self, set: &[usize]) -> f64 {
        let families = families(self.given, &self.mechanisms);
        evidence::log_prior(&hypotheses(&self.mechanisms), &families, set)
    }

    /// A set fitted from `about`.
    fn visit(
        &self,
        set: Vec<usize>,
        about: &Arm,
        noises: &[Noise],
        effort: Effort,
    ) -> Result<Visited, Unstable> {
        let free = self.free(&set);
        let mut start = pinned(self.given, about, &free);
        start.step = effort.step;
        let fitted = fit(&start, &free, self.blocks(), noises, effort, None)?;
        Ok(Visited { set, free, fitted })
    }

    /// A set sketched from a fit of its neighbour, as long as it may reach the log posterior `least`.
    fn sketch(
        &self,
        set: Vec<usize>,
        neighbour: &Visited,
        least: f64,
    ) -> Result<Visited, Unstable> {
        let free = self.free(&set);
        let (blocks, all, from) = (self.blocks(), &neighbour.free, &neighbour.fitted);
        let mut start = neighbour::start(self.given, from, all, &free, blocks, SKETCH);
        start.step = SKETCH.step;
        let least = Some(least - self.log_prior(&set));
        let fitted = fit(&start, &free, blocks, &from.noise, SKETCH, least)?;
        Ok(Visited { set, free, fitted })
    }

    /// Decisions and fits in turn.
    fn rounds(
        &self,
        mut set: Vec<usize>,
        mut about: Arm,
        most: usize,
        stage: &mut impl FnMut(&str),
    ) -> Result<Vec<Visited>, Unstable> {
        let mut noises = noise(&about, self.blocks(), &self.floors)?;
        let mut visited: Vec<Visited> = Vec::new();
        for _ in 0..most {
            stage("weighing causes");
            let next = self.expand(&about, &noises, &set)?.decide(&set).set;
            if visited.iter().any(|v| v.set == next) {
                break;
            }
            stage("fitting with the causes found");
            let own = self.visit(next, &about, &noises, SKETCH)?;
            set.clone_from(&own.set);
            about.clone_from(&own.fitted.arm);
            noises = noise(&about, self.blocks(), &self.floors)?;
            visited.push(own);
        }
        Ok(visited)
    }

    /// Index of the most probable.
    fn best(&self, visited: &[Visited]) -> Result<usize, Unstable> {
        let common = self.common(visited)?;
        Ok(largest(&self.values(visited, &common)))
    }

    /// Something unknown on the joint that a fit explains least.
    fn unknown(&self, fit: &Visited) -> Option<usize> {
        let joint = Some(fit.least_explained(&self.replayed.tracking));
        let own = |m: &Mechanism| m.effect == Effect::Unknown && m.joint == joint;
        self.mechanisms.iter().position(own)
    }

    /// Expansion in all that has a name, and in what of `set` has none: an unknown torque has more parameters than all else
    /// on its joint, and is looked for only where the others explain least.
    fn expand(&self, about: &Arm, noises: &[Noise], set: &[usize]) -> Result<Expanded, Unstable> {
        let asked: Vec<bool> = (0..self.mechanisms.len())
            .map(|m| self.mechanisms[m].effect != Effect::Unknown || set.contains(&m))
            .collect();
        let (mechanisms, always) = (&self.mechanisms, &self.always);
        expand(
            self.given,
            mechanisms,
            &asked,
            always,
            about,
            self.blocks(),
            noises,
        )
    }

    /// Decides between fitted sets by the evidence of each at its own fit, and weighs what lies around the best.
    fn decide(
        self,
        visited: Vec<Visited>,
        around: Vec<Weighed>,
        stage: &mut impl FnMut(&str),
    ) -> Result<Found, Unstable> {
        stage("comparing the likeliest");
        let noises = self.common(&visited)?;
        let values = self.values(&visited, &noises);
        let top = values[largest(&values)];
        let own = visited.into_iter().zip(values).map(|(v, u)| (v, u - top));
        let (mut rivals, noises) = self.finely(own.chain(around).collect(), &noises)?;
        let Visited { set, free, fitted } = rivals.remove(0).0;
        let mut decision = self.expand(&fitted.arm, &noises, &set)?.about(&set);
        // What a set that was fitted has beside this one is as probable as that fit says.
        for m in 0..self.mechanisms.len() {
            let mut disputed = rivals.iter();
            if let Some((_, below)) = disputed.find(|(o, _)| o.set.contains(&m) != set.contains(&m))
            {
                let odds = below.exp().min(1.0);
                let own = odds / (1.0 + odds);
                decision.inclusion[m] = if set.contains(&m) { 1.0 - own } else { own };
            }
        }
        // What the fit leaves at nothing is no cause.
        let acts = |m: usize| {
            let own = self.mechanisms[m].parameters.iter();
            let mut own = own.map(|s| s.parameter);
            own.any(|p| fitted.arm.get(p) != self.given.arm.get(p))
        };
        let kept: Vec<bool> = set.iter().map(|&m| acts(m)).collect();
        let mut keep = kept.iter();
        decision.swaps.retain(|_| *keep.next().unwrap_or(&true));
        let mut keep = kept.iter();
        decision.set.retain(|_| *keep.next().unwrap_or(&true));
        Ok(Found {
            mechanisms: self.mechanisms,
            decision,
            fitted,
            free,
            around: rivals
                .into_iter()
                .map(|(v, below)| Neighbour {
                    set: v.set,
                    arm: scored(v.fitted.arm),
                    weight: below.exp().min(1.0),
                })
                .collect(),
        })
    }

    /// Fitted sets with their log posteriors below that of the best, most probable first, and the noise. The best two are fitted and
    /// compared at the step of what is scored: a longer one leaves errors of its own, which a cause may remove.
    fn finely(
        &self,
        mut all: Vec<Weighed>,
        coarse: &[Noise],
    ) -> Result<(Vec<Weighed>, Vec<Noise>), Unstable> {
        // Of several fits of a set, the best one.
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut seen = std::collections::HashSet::new();
        all.retain(|(v, _)| seen.insert(v.set.clone()));
        let (first, _) = &all[0];
        let own = self.visit(first.set.clone(), &first.fitted.arm, coarse, LAST)?;
        // All of them are fitted under the noise under which they are compared.
        let noises = noise(&own.fitted.arm, self.blocks(), &self.floors)?;
        let mut reference: Option<Visited> = None;
        let mut from = own.fitted.arm.clone();
        while let Some(k) = (0..all.len().min(2)).find(|&k| all[k].0.fitted.arm.step != STEP) {
            let set = all[k].0.set.clone();
            if let Some(first) = &reference {
                from = self.nearer(&all[k].0.fitted.arm, &set, first, &noises);
            }
            let own = self.visit(set, &from, &noises, LAST)?;
            let value = self.value(&own, &noises);
            let base = reference.as_ref().map_or(value, |r| self.value(r, &noises));
            reference.get_or_insert_with(|| own.clone());
            all[k] = (own, value - base);
            all.sort_by(|a, b| b.1.total_cmp(&a.1));
        }
        let best = all[0].1;
        all.iter_mut().for_each(|(_, value)| *value -= best);
        Ok((all, noises))
    }

    /// Where the fit of a set starts: from an earlier fit of it or from that of a rival, whichever is better.
    fn nearer(&self, own: &Arm, set: &[usize], rival: &Visited, noises: &[Noise]) -> Arm {
        let free = self.free(set);
        let blocks = self.blocks();
        let other = neighbour::start(self.given, &rival.fitted, &rival.free, &free, blocks, LAST);
        let value = |arm: &Arm| {
            let mut arm = pinned(self.given, arm, &free);
            arm.step = LAST.step;
            objective(&arm, &free, blocks, noises).unwrap_or(f64::INFINITY)
        };
        if value(&other) < value(own) {
            other
        } else {
            own.clone()
        }
    }
}

/// The arm as it is scored.
fn scored(mut arm: Arm) -> Arm {
    arm.step = STEP;
    arm
}
