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
pub use refit::{finely, named, refit, refit_finely};

use crate::arm::{Arm, STEP};
use crate::catalogue::{self, Effect, Mechanism, Sizes};
use crate::fit::{Effort, Fitted, Free, Noise, fit, noise, objective};
use crate::given::Given;
use crate::simulate::{Track, Unstable};
use crate::tracks::Replayed;
use effort::{LAST, SKETCH};
use evidence::{Decision, Problem};
use expand::{expand, families, hypotheses};
use free::{Entry, always, pinned};
use visited::{Visited, joined, largest};

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
    /// Other sets that were fitted, most probable first.
    pub around: Vec<Neighbour>,
}

/// Set of mechanisms that was fitted beside the most probable one.
#[derive(Debug, Clone)]
pub struct Neighbour {
    /// Mechanisms of the set, indices increasing.
    pub set: Vec<usize>,
    /// Arm at the set's fit, with the step of what is scored.
    pub arm: Arm,
    /// Posterior probability of the set, divided by that of the most probable one; at most 1.
    pub weight: f64,
}

impl Found {
    /// Joints on which something unknown is more probable than not, each with its inclusion probability.
    pub fn unknown(&self) -> Vec<(usize, f64)> {
        let of = |&m: &usize| {
            let own = &self.mechanisms[m];
            let probability = self.decision.inclusion[m];
            let kept = own.effect == Effect::Unknown && probability >= 0.5;
            own.joint.filter(|_| kept).map(|j| (j, probability))
        };
        self.decision.set.iter().filter_map(of).collect()
    }

    /// Mechanisms of the set that have a name: all but unknown torques.
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

/// Fitted set with its log posterior relative to that of the most probable one, nats.
type Weighed = (Visited, f64);

/// Search for the set of effects on one recording: what all its fits share.
struct Search<'a> {
    given: &'a Given,
    replayed: &'a Replayed,
    mechanisms: Vec<Mechanism>,
    /// Parameters that are free under every set.
    always: Vec<Entry>,
    /// Error variance of each joint by its encoder's count, rad².
    floors: Vec<f64>,
    /// Integrated autocorrelation time of the errors, samples, before a fit has shown it.
    correlation: f64,
}

impl Search<'_> {
    fn blocks(&self) -> &[Track] {
        &self.replayed.blocks
    }

    /// Noise of each joint before a fit has shown its own.
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

    /// Noise of each joint in the fit with the lowest misfit. All sets are compared under it.
    fn common(&self, visited: &[Visited]) -> Result<Vec<Noise>, Unstable> {
        let first = self.first();
        let closest = visited
            .iter()
            .min_by(|a, b| a.misfit(&first).total_cmp(&b.misfit(&first)))
            .map_or(&self.given.arm, |v| &v.fitted.arm);
        noise(closest, self.blocks(), &self.floors)
    }

    /// Log posterior of each fitted set under common noise, nats, up to a constant.
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

    /// Fit of `set` that starts from the values of the arm `about`.
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

    /// Short fit of `set` that starts from the fit of a neighbour. It ends early where it cannot reach the log posterior
    /// `least`, nats.
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

    /// Sets that are found by deciding on an expansion and fitting what was decided in turn, at most `most` times, from
    /// the set `set` with the arm `about`.
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
            let mut next = self.expand(&about, &noises, &set)?.decide(&set).set;
            if visited.iter().any(|v| v.set == next) {
                // The expansion shows no limit that is never met.
                let (cut, lower) = self.cut(&about, &set, &noises)?;
                (next, about) = (joined(&set, &cut), lower);
                if cut.is_empty() || visited.iter().any(|v| v.set == next) {
                    break;
                }
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

    /// Index of the most probable fitted set.
    fn best(&self, visited: &[Visited]) -> Result<usize, Unstable> {
        let common = self.common(visited)?;
        Ok(largest(&self.values(visited, &common)))
    }

    /// Mechanism of an unknown torque on the joint that a fit explains least.
    fn unknown(&self, fit: &Visited) -> Option<usize> {
        let joint = Some(fit.least_explained(&self.replayed.tracking));
        let own = |m: &Mechanism| m.effect == Effect::Unknown && m.joint == joint;
        self.mechanisms.iter().position(own)
    }

    /// Comparison about an arm of all mechanisms with a name, and of the unknown torques in `set`. An unknown torque has
    /// more parameters than all else on its joint, so that others are left out.
    fn expand(&self, about: &Arm, noises: &[Noise], set: &[usize]) -> Result<Problem, Unstable> {
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

    /// Result of the search: the most probable of the fitted sets by the evidence of each at its own fit, with what lies
    /// around it.
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

    /// Fitted sets with their log posteriors relative to the best, most probable first, and the noise of each joint. The
    /// best two are fitted again and compared at the step of what is scored: a longer step leaves errors of its own,
    /// which a cause may remove.
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

    /// Arm from which a fit of `set` starts: its earlier fit `own` or that of a rival, whichever has the lower objective.
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

/// Arm with the step of what is scored.
fn scored(mut arm: Arm) -> Arm {
    arm.step = STEP;
    arm
}
