//! Which effects the motion shows: fits, expansion about them, and the decision by evidence.

mod effort;
mod expand;
mod free;
mod neighbour;
mod refit;
mod visited;

pub use effort::COARSE;
pub use free::{RELATIVE, STANDSTILL};
pub use refit::{named, refit, refit_finely};
pub use visited::SMALL;

use crate::arm::{Arm, STEP};
use crate::catalogue::{self, Effect, Mechanism, Sizes};
use crate::fit::{Effort, Fitted, Free, Noise, descend, fit, noise, objective};
use crate::given::Given;
use crate::simulate::{Track, Unstable};
use crate::tracks::Replayed;
use effort::{FIRST, LAST, NEXT, SKETCH};
use evidence::Decision;
use expand::{Expanded, ODDS, expand, families, family, hypotheses};
use free::{Entry, always, pinned};
use visited::{Visited, largest};

/// Single effects, of different kinds, that are fitted before the rounds.
const SINGLES: usize = 4;

/// Rounds of fits around the best set.
const AROUND: usize = 2;

/// Rounds of fit and decision; the set is stable after three in most cases. From a single effect that leaves more than it
/// should, a second one is found in one.
const ROUNDS: usize = 5;
const FEW: usize = 1;

/// The state of a diagnosis: what is free under the causes found.
#[derive(Debug, Clone)]
pub struct Found {
    /// Mechanisms that were compared.
    pub mechanisms: Vec<Mechanism>,
    /// Those that are listed, with their inclusion probabilities.
    pub decision: Decision,
    /// Fit with the listed mechanisms.
    pub fitted: Fitted,
    /// Its free parameters.
    pub free: Vec<Free>,
    /// Sets around it that were fitted, with their arms.
    pub around: Vec<(Vec<usize>, Arm)>,
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

/// Finds the effects that explain the motion of `replayed`.
///
/// # Errors
/// The simulator as given is unstable.
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
    search.decide(visited, others)
}

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
        let families = families(self.given, &self.mechanisms);
        let hypotheses = hypotheses(&self.mechanisms);
        let of = |v: &Visited| {
            v.log_evidence(noises) + evidence::log_prior(&hypotheses, &families, &v.set)
        };
        visited.iter().map(of).collect()
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
        let fitted = fit(&start, &free, self.blocks(), noises, effort)?;
        Ok(Visited { set, free, fitted })
    }

    /// A set sketched from a fit of its neighbour.
    fn sketch(&self, set: Vec<usize>, neighbour: &Visited) -> Result<Visited, Unstable> {
        let free = self.free(&set);
        let (blocks, all, from) = (self.blocks(), &neighbour.free, &neighbour.fitted);
        let mut start = neighbour::start(self.given, from, all, &free, blocks, SKETCH);
        start.step = SKETCH.step;
        let fitted = fit(&start, &free, blocks, &from.noise, SKETCH)?;
        Ok(Visited { set, free, fitted })
    }

    /// Sets that are found from nothing but tolerances. About it a large effect is far from linear, so that the likeliest single
    /// effects are fitted each for itself; the best of them is where the rounds begin.
    fn bare(&self, stage: &mut impl FnMut(&str)) -> Result<Vec<Visited>, Unstable> {
        stage("fitting single causes");
        let (given, blocks, first) = (self.given, self.blocks(), self.first());
        let free = self.free(&[]);
        let mut about = given.arm.clone();
        about.step = COARSE;
        (about, _) = descend(&about, &free, blocks, &first, FIRST)?;
        let noises = noise(&about, blocks, &self.floors)?;
        let nothing = self.visit(Vec::new(), &about, &noises, SKETCH)?;
        let vague: Vec<usize> = self.unknown(&nothing).into_iter().collect();
        let simplest = self.expand(&about, &noises, &vague)?.simplest();
        let mut sketches = vec![nothing];
        let mut lower = about.clone();
        let cut = cut(given, &mut lower, &self.mechanisms, &free, blocks, &first)?;
        if !cut.is_empty() {
            sketches.push(self.visit(cut, &lower, &noises, SKETCH)?);
        }
        let mut tried = Vec::new();
        for set in simplest {
            let own = family(&self.mechanisms[set[0]]);
            if tried.contains(&own) || (tried.len() >= SINGLES && own.0 != Effect::Unknown) {
                continue;
            }
            tried.push(own);
            // What cannot be simulated with its own fit is no explanation.
            sketches.extend(self.visit(set, &about, &noises, SKETCH).ok());
        }
        let common = self.common(&sketches)?;
        let values = self.values(&sketches, &common);
        let best = largest(&values);
        let Visited { set, fitted, .. } = sketches.swap_remove(best);
        let own = self.visit(set, &fitted.arm, &common, SKETCH)?;
        let most = if own.explains(&self.replayed.tracking) {
            ROUNDS
        } else {
            FEW
        };
        let mut visited = self.rounds(own.set.clone(), own.fitted.arm.clone(), most, stage)?;
        visited.push(own);
        Ok(visited)
    }

    /// Sets that are found from all that every servo has.
    fn equipped(&self, stage: &mut impl FnMut(&str)) -> Result<Vec<Visited>, Unstable> {
        stage("fitting drives and joints");
        let (given, blocks, first) = (self.given, self.blocks(), self.first());
        let mut set: Vec<usize> = (0..self.mechanisms.len())
            .filter(|&m| is_core(&self.mechanisms[m]))
            .collect();
        let free = self.free(&set);
        let mut about = given.arm.clone();
        about.step = COARSE;
        (about, _) = descend(&about, &free, blocks, &first, FIRST)?;
        let cut = cut(given, &mut about, &self.mechanisms, &free, blocks, &first)?;
        if !cut.is_empty() {
            set.extend(&cut);
            set.sort_unstable();
            (about, _) = descend(&about, &self.free(&set), blocks, &first, FIRST)?;
        }
        self.rounds(set, about, ROUNDS, stage)
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

    /// Adds fits of what lies around the best set and is far from linear: without each effect, and with something unknown on
    /// the joint that is explained least, beside the named effects of that joint or in their place. Returns those of the last
    /// round, with their probabilities relative to the best.
    fn around(
        &self,
        visited: &mut Vec<Visited>,
        stage: &mut impl FnMut(&str),
    ) -> Result<Vec<(Visited, f64)>, Unstable> {
        stage("fitting without each cause");
        let mut others = Vec::new();
        let best = visited.swap_remove(self.best(visited)?);
        let common = self.common(std::slice::from_ref(&best))?;
        visited.push(self.visit(best.set, &best.fitted.arm, &common, NEXT)?);
        for round in 0..AROUND {
            let best = self.best(visited)?;
            let mut sketches = Vec::new();
            for set in self.beside(&visited[best]) {
                sketches.extend(self.sketch(set, &visited[best]).ok());
            }
            sketches.push(visited.swap_remove(best));
            let common = self.common(&sketches)?;
            let values = self.values(&sketches, &common);
            let next = largest(&values);
            let own = sketches.pop().expect("it was put there");
            visited.push(own);
            let moves =
                next < sketches.len() && visited.iter().all(|v| v.set != sketches[next].set);
            if moves {
                let (set, arm) = (sketches[next].set.clone(), &sketches[next].fitted.arm);
                visited.push(self.visit(set, arm, &common, NEXT)?);
            }
            if !moves || round + 1 == AROUND {
                let weights = values.iter().map(|v| (v - values[next]).exp());
                others = sketches.into_iter().zip(weights).collect();
                break;
            }
        }
        Ok(others)
    }

    /// Sets around a fit that are far from linear: without each effect, and with something unknown on the joint that is
    /// explained least, beside the named effects of that joint or in their place.
    fn beside(&self, fit: &Visited) -> Vec<Vec<usize>> {
        let set = &fit.set;
        let of = |m: usize| family(&self.mechanisms[m]);
        let mut kinds: Vec<(Effect, bool)> = set.iter().map(|&m| of(m)).collect();
        kinds.sort_unstable();
        kinds.dedup();
        let mut sets: Vec<Vec<usize>> = kinds
            .into_iter()
            .map(|kind| set.iter().copied().filter(|&m| of(m) != kind).collect())
            .collect();
        if let Some(unknown) = self.unknown(fit).filter(|u| !set.contains(u)) {
            let joint = self.mechanisms[unknown].joint;
            let elsewhere = |m: &usize| self.mechanisms[*m].joint != joint;
            for kept in [set.clone(), set.iter().copied().filter(elsewhere).collect()] {
                let mut with: Vec<usize> = kept;
                with.push(unknown);
                with.sort_unstable();
                sets.push(with);
            }
        }
        sets.sort_unstable();
        sets.dedup();
        sets
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
        mut visited: Vec<Visited>,
        around: Vec<(Visited, f64)>,
    ) -> Result<Found, Unstable> {
        let noises = self.common(&visited)?;
        let values = self.values(&visited, &noises);
        let best = largest(&values);
        let fitted = visited.iter().zip(&values);
        let others: Vec<(Vec<usize>, f64)> = fitted
            .map(|(v, value)| (v.set.clone(), (value - values[best]).exp()))
            .chain(around.iter().map(|(v, weight)| (v.set.clone(), *weight)))
            .collect();
        let own = visited.swap_remove(best);
        let Visited { set, free, fitted } = self.visit(own.set, &own.fitted.arm, &noises, LAST)?;
        let mut decision = self.expand(&fitted.arm, &noises, &set)?.about(&set);
        // What a set that was fitted has beside this one is as probable as that fit says.
        for m in 0..self.mechanisms.len() {
            let disputed = others
                .iter()
                .filter(|(o, _)| o.contains(&m) != set.contains(&m));
            if let Some(odds) = disputed.map(|(_, w)| *w).reduce(f64::max) {
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
            around: around
                .into_iter()
                .map(|(v, _)| (v.set, finely(v.fitted.arm)))
                .collect(),
        })
    }
}

/// Parts of a given limit at which a cut is tried: a limit that is never reached has no derivative.
const PARTS: [f64; 5] = [0.7, 0.5, 0.35, 0.25, 0.18];

/// Limits, joint by joint, that are set lower where that fits better than by their odds; the mechanisms of those.
fn cut(
    given: &Given,
    about: &mut Arm,
    mechanisms: &[Mechanism],
    free: &[Free],
    blocks: &[Track],
    noise: &[Noise],
) -> Result<Vec<usize>, Unstable> {
    let mut out = Vec::new();
    let mut least = objective(about, free, blocks, noise)?;
    for (m, own) in mechanisms.iter().enumerate() {
        if own.effect != Effect::EffortLimit {
            continue;
        }
        let parameter = own.parameters[0].parameter;
        let whole = given.arm.get(parameter);
        let mut found = false;
        for part in PARTS {
            let mut trial = about.clone();
            let tried = trial.set(&[(parameter, part * whole)]);
            let value = tried
                .ok()
                .and_then(|()| objective(&trial, free, blocks, noise).ok());
            if let Some(value) = value.filter(|v| *v < least + ODDS.ln()) {
                (least, found) = (value, true);
                *about = trial;
            }
        }
        if found {
            out.push(m);
        }
    }
    Ok(out)
}

/// The arm as it is scored.
fn finely(mut arm: Arm) -> Arm {
    arm.step = STEP;
    arm
}

/// What the first fit frees: a drive and a joint as every servo has them.
fn is_core(m: &Mechanism) -> bool {
    let lag = m.effect == Effect::CommandDelay && m.joint.is_some();
    let core = [
        Effect::ServoGain,
        Effect::FrictionParameters,
        Effect::RotorInertia,
        Effect::CommandDelay,
        Effect::EncoderOffset,
    ];
    core.contains(&m.effect) && !lag
}
