//! Evidence for the name of a cause: the recording is simulated as if the cause, or a rival, were true, and named again.
//!
//! For the cause and for each of its rivals, surrogates are drawn from the fit with it in the cause's place. On
//! each, the shapes of the cause and of the rival are tried again. The lead of the cause over the rival has one
//! distribution where the cause is true and another where the rival is; their densities at the observed lead
//! give the likelihood ratio. They are modelled by Student's t with few degrees of freedom, so that no
//! recording makes a name certain. Parameters are no such rivals: free parameters imitate nearly everything,
//! and the evidence against them is their penalty, which the lead includes. Lines over position are tried at
//! the orders that the recording showed, not picked again.

use super::Source;
use super::null_torque::draw;
use crate::algebra::batched_trials::Fitted;
use crate::catalogue::effect::Effect;
use crate::search::find::{Accepted, Findings};
use crate::search::select::without;
use rayon::prelude::*;
use statrs::distribution::{Continuous, StudentsT};

/// Seed from which the surrogates are drawn.
const SEED: u64 = 0xCAFE;
/// Number of surrogates of each truth.
const SURROGATES: u64 = 40;
/// Fewest stretches of time, whose random signs distinguish the surrogates: half a minute of them.
const STRETCHES: usize = 20;
/// Largest number of rivals of a cause.
const RIVALS: usize = 6;
/// Largest number of shapes of one name that are tried.
const SHAPES: usize = 6;
/// Gain of a name whose coefficients are out of bounds, nats.
const NOTHING: f64 = -20.0;
/// Degrees of freedom of Student's t for the leads.
const FREEDOM: f64 = 4.0;
/// Least standard deviation of a lead, nats: the contribution of a model that is only nearly right.
const LEAST: f64 = 2.0;
/// Bound on a log likelihood ratio from simulations, nats: it lies between minus and plus this.
const MOST: f64 = 5.0;

/// Evidence for the name of a cause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Naming {
    /// Gain over the best other name, parameters and the same effect at another place included, nats.
    pub lead: f64,
    /// Log of the cause's likelihood over that of its rivals together, from the leads on surrogates.
    pub likeness: f64,
}

/// A name: an effect at one place.
struct Name {
    /// Candidates of the name: the one with which it is simulated, then others, best first.
    shapes: Vec<usize>,
    /// Gain of its best candidate on the recording, nats.
    gain: f64,
}

impl Source<'_> {
    /// Evidence for the name of each accepted cause. None for parameters, for a cause without rivals, and for a
    /// recording that is too short.
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

    /// Largest gain of a name's shapes on each surrogate, nats.
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

/// Largest gain of any other name in a cause's place, nats; zero where no other name was tried.
fn best_other(found: &Findings, cause: &Accepted) -> f64 {
    let own = place(found, cause.candidate);
    let mut others = cause.tried.iter();
    let best = others.find(|t| place(found, t.candidate) != own);
    best.map_or(0.0, |t| t.gain.max(0.0))
}

/// The cause, then its rivals: the best other names, whatever their gain.
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

/// Probability density at the lead `at` among simulated leads.
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
