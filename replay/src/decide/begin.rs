//! Where the rounds of a decision begin: from nothing but tolerances, or from all that every servo has.

use super::Search;
use super::effort::{COARSE, FIRST, SKETCH};
use super::expand::family;
use super::visited::{Visited, joined, largest};
use crate::catalogue::{Effect, Mechanism};
use crate::fit::{descend, noise};
use crate::simulate::Unstable;

/// Largest number of single effects, each of another kind, that are fitted before the rounds.
const SINGLES: usize = 4;

/// Largest number of rounds of decision and fit; the set is stable after three in most cases.
const ROUNDS: usize = 5;
/// Number of rounds from a single effect that leaves more than it should: a second effect is found in one.
const FEW: usize = 1;

impl Search<'_> {
    /// Sets that are found from nothing but tolerances. A large effect is far from linear there. The likeliest single
    /// effects are therefore fitted each for itself, and the rounds begin at the best of them.
    pub(super) fn bare(&self, stage: &mut impl FnMut(&str)) -> Result<Vec<Visited>, Unstable> {
        stage("fitting single causes");
        let (given, blocks, first) = (self.given, self.blocks(), self.first());
        let free = self.free(&[]);
        let mut about = given.arm.clone();
        about.step = COARSE;
        about = descend(&about, &free, blocks, &first, FIRST, None)?.arm;
        let noises = noise(&about, blocks, &self.floors)?;
        let nothing = self.visit(Vec::new(), &about, &noises, SKETCH)?;
        let vague: Vec<usize> = self.unknown(&nothing).into_iter().collect();
        let simplest = self.expand(&about, &noises, &vague)?.simplest();
        let mut sketches = vec![nothing];
        let (cut, lower) = self.cut(&about, &[], &first)?;
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
        let Visited { set, fitted, .. } = &sketches[best];
        let own = self.visit(set.clone(), &fitted.arm, &common, SKETCH)?;
        let most = if own.explains(&self.replayed.tracking) {
            ROUNDS
        } else {
            FEW
        };
        let mut visited = self.rounds(own.set.clone(), own.fitted.arm.clone(), most, stage)?;
        visited.push(own);
        visited.extend(sketches);
        Ok(visited)
    }

    /// Sets that are found from a fit of all that every servo has; see [`is_core`].
    pub(super) fn equipped(&self, stage: &mut impl FnMut(&str)) -> Result<Vec<Visited>, Unstable> {
        stage("fitting drives and joints");
        let (given, blocks, first) = (self.given, self.blocks(), self.first());
        let mut set: Vec<usize> = (0..self.mechanisms.len())
            .filter(|&m| is_core(&self.mechanisms[m]))
            .collect();
        let free = self.free(&set);
        let mut about = given.arm.clone();
        about.step = COARSE;
        about = descend(&about, &free, blocks, &first, FIRST, None)?.arm;
        let (cut, lower) = self.cut(&about, &set, &first)?;
        if !cut.is_empty() {
            (set, about) = (joined(&set, &cut), lower);
            about = descend(&about, &self.free(&set), blocks, &first, FIRST, None)?.arm;
        }
        self.rounds(set, about, ROUNDS, stage)
    }
}

/// Whether the first fit of all that every servo has frees the mechanism: gains, friction, rotor inertia, common delay
/// and encoder offsets.
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
