//! How surely a cause has the right name: the same recording simulated as if it, or a rival, were true, and named again.
//!
//! For the cause and for each of its rivals, surrogates are drawn from the fit that has it in the cause's place. On each, the shapes of
//! the cause and of the rival are tried again; the lead of the cause over the rival is distributed one way where the cause is true and
//! another where the rival is. Where the observed lead lies between the two says how many times as likely one is as the
//! other. Leads are compared by Student's t with few degrees of freedom, so that no recording makes a name certain. Parameters are
//! no such rivals: what is free imitates nearly everything, and what speaks against it is its price, which the lead holds. Lines over
//! position are tried at the orders that the recording showed, not picked again.

use super::Source;
use super::null_torque::draw;
use crate::algebra::batched_trials::Fitted;
use crate::catalogue::effect::Effect;
use crate::search::find::{Accepted, Findings};
use crate::search::select::without;
use rayon::prelude::*;
use statrs::distribution::{Continuous, StudentsT};

/// Seed of the surrogates.
const SEED: u64 = 0xCAFE;
/// Surrogates of each truth.
const SURROGATES: u64 = 40;
/// Fewest stretches of time, whose signs the surrogates differ by: half a minute of them.
const STRETCHES: usize = 20;
/// Most rivals of a cause.
const RIVALS: usize = 6;
/// Most shapes of one name that are tried.
const SHAPES: usize = 6;
/// Gain that stands for none at all, nats.
const NOTHING: f64 = -20.0;
/// Degrees of freedom of the leads' distributions.
const FREEDOM: f64 = 4.0;
/// Least deviation of a lead, nats: what a model that is only nearly right adds.
const LEAST: f64 = 2.0;
/// Largest logarithm of odds that simulations may speak for or against a name with.
const MOST: f64 = 5.0;

/// How surely a cause is named.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Naming {
    /// Gain over the best other name, parameters and the same effect at another place included, nats.
    pub lead: f64,
    /// Logarithm of how many times as likely as its rivals together the cause is, going by its leads over them.
    pub likeness: f64,
}

/// One name, an effect at a place.
struct Name {
    /// Its candidates: the one that it is simulated by, then others, best first.
    shapes: Vec<usize>,
    /// Gain of the best of them on the recording.
    gain: f64,
}

impl Source<'_> {
    /// How surely each accepted cause has the right name; none for parameters, where nothing else could be it, and where the recording is
    /// too short.
    pub fn namings(&self, found: &Findings) -> Vec<Option<Naming>> {
        let named = |c: usize| !found.candidate(c).effect.info().parameter;
        let long = self.stretches.fold.len() >= STRETCHES;
        (0..found.accepted.len())
            .map(|c| {
                if long && named(c) {
                    self.naming(found, c)
                } else {
                    None
                }
            })
            .collect()
    }

    fn naming(&self, found: &Findings, cause: usize) -> Option<Naming> {
        let accepted: Vec<usize> = found.accepted.iter().map(|a| a.candidate).collect();
        let others = without(&accepted, cause);
        let names = names(found, &found.accepted[cause]);
        let (own, rivals) = names.split_first().filter(|(_, r)| !r.is_empty())?;
        let fit = self.search.fit(&others);
        // Torques where a name is true, fitted without it. Each name has surrogates of its own.
        let as_if = |name: &Name, number: u64| {
            let truth = self.search.fit(&[&others[..], &name.shapes[..1]].concat());
            let stretches = self.stretches.fold.len();
            let drawn = draw(&truth, stretches, SEED + number, 0..SURROGATES);
            Fitted::new(&fit, &drawn.products(&truth, &self.stretches))
        };
        let leads = |fitted: &Fitted, rival: &Name| -> Vec<f64> {
            let [own, rival] = [own, rival].map(|name| self.best(name, fitted));
            own.iter().zip(&rival).map(|(a, b)| a - b).collect()
        };
        let true_own = as_if(own, 0);
        let odds: Vec<f64> = rivals
            .par_iter()
            .enumerate()
            .map(|(r, rival)| {
                let seen = own.gain - rival.gain;
                let if_rival = leads(&as_if(rival, 1 + r as u64), rival);
                density(&if_rival, seen) / density(&leads(&true_own, rival), seen)
            })
            .collect();
        let cause = &found.accepted[cause];
        Some(Naming {
            lead: own.gain - best_other(found, cause),
            likeness: (-odds.iter().sum::<f64>().ln()).clamp(-MOST, MOST),
        })
    }

    /// Largest gain of a name's shapes on each surrogate.
    fn best(&self, name: &Name, fitted: &Fitted) -> Vec<f64> {
        let before = self.values(fitted);
        let places = self.search.places();
        let mut best = vec![NOTHING; before.len()];
        for &c in &name.shapes {
            let trials = fitted.trials(&self.search.variables(c));
            for ((best, &before), trial) in best.iter_mut().zip(&before).zip(&trials) {
                let gain = self.search.gain_among(c, before, trial, &places);
                *best = best.max(gain.unwrap_or(NOTHING));
            }
        }
        best
    }
}

/// Effect, joints and driver of a candidate.
fn place(found: &Findings, candidate: usize) -> (Effect, &[usize], Option<usize>) {
    let c = &found.candidates[candidate];
    (c.effect, &c.joints, c.driver)
}

/// Largest gain of any other name in a cause's place; zero where there is none.
fn best_other(found: &Findings, cause: &Accepted) -> f64 {
    let own = place(found, cause.candidate);
    let mut others = cause.tried.iter();
    let best = others.find(|t| place(found, t.candidate) != own);
    best.map_or(0.0, |t| t.gain.max(0.0))
}

/// The cause, then its rivals: the best of the other names, whatever they gain.
fn names(found: &Findings, cause: &Accepted) -> Vec<Name> {
    let place = |candidate: usize| place(found, candidate);
    let name = |candidate: usize| {
        let tried = cause.tried.iter();
        let same = tried.filter(|t| place(t.candidate) == place(candidate));
        let others = same
            .clone()
            .map(|t| t.candidate)
            .filter(|c| *c != candidate);
        Name {
            gain: same.clone().next().map_or(NOTHING, |t| t.gain),
            shapes: [candidate].into_iter().chain(others).take(SHAPES).collect(),
        }
    };
    let mut names = vec![name(cause.candidate)];
    let parameter = |candidate: usize| found.candidates[candidate].effect.info().parameter;
    for t in cause.tried.iter().filter(|t| !parameter(t.candidate)) {
        let known = |n: &Name| place(n.shapes[0]) == place(t.candidate);
        if names.len() <= RIVALS && !names.iter().any(known) {
            names.push(name(t.candidate));
        }
    }
    names
}

/// Density of a lead among simulated ones.
fn density(leads: &[f64], at: f64) -> f64 {
    let n = leads.len() as f64;
    let mean = leads.iter().sum::<f64>() / n;
    let variance = leads.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let scale = variance.sqrt().max(LEAST);
    StudentsT::new(mean, scale, FREEDOM).map_or(f64::NAN, |t| t.pdf(at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lead_is_likely_where_it_was_simulated() {
        let (a, b): (Vec<f64>, Vec<f64>) = (0..40)
            .map(|i| (50.0 + f64::from(i % 7), -30.0 - f64::from(i % 5)))
            .unzip();
        assert!(density(&a, 52.0) > 100.0 * density(&b, 52.0));
        assert!(density(&b, -31.0) > 100.0 * density(&a, -31.0));
    }
}
