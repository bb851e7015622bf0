//! Where the rounds of a decision begin: from nothing but tolerances, or from all that every servo has.

use super::Search;
use super::effort::{COARSE, FIRST, SKETCH};
use super::expand::{ODDS, family};
use super::visited::{Visited, largest};
use crate::arm::Arm;
use crate::catalogue::{Effect, Mechanism};
use crate::fit::{Free, Noise, descend, noise, objective};
use crate::given::Given;
use crate::simulate::{Track, Unstable};

/// Single effects, of different kinds, that are fitted before the rounds.
const SINGLES: usize = 4;

/// Rounds of fit and decision; the set is stable after three in most cases. From a single effect that leaves more than it
/// should, a second one is found in one.
const ROUNDS: usize = 5;
const FEW: usize = 1;

impl Search<'_> {
    /// Sets that are found from nothing but tolerances. About it a large effect is far from linear, so that the likeliest single
    /// effects are fitted each for itself; the best of them is where the rounds begin.
    pub(super) fn bare(&self, stage: &mut impl FnMut(&str)) -> Result<Vec<Visited>, Unstable> {
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
    pub(super) fn equipped(&self, stage: &mut impl FnMut(&str)) -> Result<Vec<Visited>, Unstable> {
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
