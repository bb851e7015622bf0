//! Decision which effects the motion shows: fits, expansions of the likelihood about them, and posterior probabilities.

mod expand;
mod free;
mod refit;

pub use free::RELATIVE;
pub use refit::refit;

use crate::arm::{Arm, STEP};
use crate::catalogue::{self, Effect, Mechanism, Sizes};
use crate::fit::{Effort, Fitted, Free, Noise, descend, fit, noise, objective};
use crate::given::Given;
use crate::simulate::{Track, Unstable};
use crate::tracks::Replayed;
use evidence::Decision;
use expand::{ODDS, beside, expand, families, hypotheses};
use free::{always, pinned};

/// Integration step, s, of fits that only give start values or measure a cause's share.
pub const COARSE: f64 = 4e-3;

/// Effort of the first fit, from the given values.
const FIRST: Effort = Effort {
    iterations: 25,
    gain: 0.5,
    step: COARSE,
};

/// Effort of a fit that starts at the optimum of a similar set of hypotheses. A tenth of a nat changes no conclusion.
const NEXT: Effort = Effort {
    iterations: 10,
    gain: 0.1,
    step: STEP,
};

/// Largest number of rounds of fit and decision; the set is stable after three in most cases.
const ROUNDS: usize = 5;

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
    /// Joints on which an unknown torque, beside the set, is more probable than not: index of the joint and
    /// probability.
    pub unknown: Vec<(usize, f64)>,
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
    let mechanisms = catalogue::mechanisms(given, replayed, &sizes);
    let always = always(given, &sizes);
    let blocks = &replayed.blocks;
    let floors: Vec<f64> = replayed
        .quantum
        .iter()
        .map(|q| (q * q / 12.0).max(1e-14))
        .collect();
    stage("fitting drives and joints");
    let mut set: Vec<usize> = (0..mechanisms.len())
        .filter(|&m| is_core(&mechanisms[m]))
        .collect();
    let first: Vec<Noise> = floors
        .iter()
        .map(|&floor| Noise {
            floor,
            // Autocorrelation time of a quarter of a second, until the first fit's errors show their own.
            correlation: (0.25 / sizes.period).max(1.0),
        })
        .collect();
    let free = free::free(given, &mechanisms, &set, &always);
    let (mut about, _) = descend(&given.arm, &free, blocks, &first, FIRST)?;
    let cut = cut(given, &mut about, &mechanisms, &free, blocks, &first)?;
    set.extend(&cut);
    set.sort_unstable();
    if !cut.is_empty() {
        let free = free::free(given, &mechanisms, &set, &always);
        (about, _) = descend(&about, &free, blocks, &first, FIRST)?;
    }
    let mut noises = noise(&about, blocks, &floors)?;
    let mut visited: Vec<Visited> = Vec::new();
    for _ in 0..ROUNDS {
        stage("weighing causes");
        let expanded = expand(given, &mechanisms, &always, &about, blocks, &noises)?;
        let next = expanded.decide(&set).set;
        if visited.iter().any(|v| v.set == next) {
            break;
        }
        set = next;
        stage("fitting with the causes found");
        let free = free::free(given, &mechanisms, &set, &always);
        let start = pinned(given, &about, &free);
        let fitted = fit(&start, &free, blocks, &noises, NEXT)?;
        noises = noise(&fitted.arm, blocks, &floors)?;
        about.clone_from(&fitted.arm);
        visited.push(Visited {
            set: set.clone(),
            free,
            fitted,
        });
    }
    // Comparison of all fitted sets, each by its own fit. Where rounds alternate between sets, their expansions
    // disagree.
    let mut best = (f64::NEG_INFINITY, 0);
    let mut values = Vec::new();
    let families = families(given, &mechanisms);
    let hypotheses = hypotheses(&mechanisms);
    for (k, v) in visited.iter().enumerate() {
        let prior = evidence::log_prior(&hypotheses, &families, &v.set);
        let value = v.log_evidence(blocks, &noises)? + prior;
        values.push(value);
        if value > best.0 {
            best = (value, k);
        }
    }
    let others: Vec<(Vec<usize>, f64)> = visited
        .iter()
        .zip(&values)
        .map(|(v, value)| (v.set.clone(), (value - best.0).exp()))
        .collect();
    let Visited {
        set,
        free,
        mut fitted,
    } = visited.swap_remove(best.1);
    fitted.noise.clone_from(&noises);
    let expanded = expand(given, &mechanisms, &always, &fitted.arm, blocks, &noises)?;
    let mut decision = expanded.about(&set);
    // Inclusion probability from the fits: a fitted set that disagrees about a mechanism counts by its own evidence.
    for m in 0..mechanisms.len() {
        let disputed = others
            .iter()
            .filter(|(o, _)| o.contains(&m) != set.contains(&m));
        if let Some(odds) = disputed.map(|(_, w)| *w).reduce(f64::max) {
            let own = odds / (1.0 + odds);
            decision.inclusion[m] = if set.contains(&m) { 1.0 - own } else { own };
        }
    }
    // Mechanisms whose parameters stay at their given values are no cause.
    let acts = |m: usize| {
        let own = mechanisms[m].parameters.iter();
        let mut own = own.map(|s| s.parameter);
        own.any(|p| fitted.arm.get(p) != given.arm.get(p))
    };
    let kept: Vec<bool> = set.iter().map(|&m| acts(m)).collect();
    let mut keep = kept.iter();
    decision.swaps.retain(|_| *keep.next().unwrap_or(&true));
    let mut keep = kept.iter();
    decision.set.retain(|_| *keep.next().unwrap_or(&true));
    stage("looking for something unknown");
    let unknown = beside(
        given,
        &mechanisms,
        &always,
        &fitted.arm,
        replayed,
        &noises,
        &decision.set,
        &sizes,
    )?;
    Ok(Found {
        mechanisms,
        decision,
        fitted,
        free,
        unknown,
    })
}

/// Set of mechanisms that was fitted in a round of the search.
struct Visited {
    /// Indices of the mechanisms of the set.
    set: Vec<usize>,
    /// Free parameters of the fit.
    free: Vec<Free>,
    /// Result of the fit.
    fitted: Fitted,
}

impl Visited {
    /// Log evidence of the set, nats, up to a constant: Laplace approximation at the set's own fit.
    fn log_evidence(&self, blocks: &[Track], noises: &[Noise]) -> Result<f64, Unstable> {
        let value = objective(&self.fitted.arm, &self.free, blocks, noises)?;
        let mut precision = self.fitted.information.clone();
        let mut log_prior = 0.0;
        for (i, f) in self.free.iter().enumerate() {
            if let Some((_, deviation)) = f.prior {
                precision[(i, i)] += deviation.powi(-2);
                log_prior -= deviation.ln();
            }
        }
        let determinant = precision.cholesky().map_or(f64::INFINITY, |c| {
            c.l_dirty().diagonal().iter().map(|l| l.ln()).sum()
        });
        Ok(log_prior - value - determinant)
    }
}

/// Parts of a given torque limit that are tried as lower limits. A limit that is never reached has no derivative, so
/// that a fit cannot find it.
const PARTS: [f64; 5] = [0.7, 0.5, 0.35, 0.25, 0.18];

/// Lowers torque limits of the arm `about`, joint by joint, where that improves the objective by more than the prior
/// odds of the effect cost. Returns the indices of those joints' limit mechanisms.
fn cut(
    given: &Given,
    about: &mut Arm,
    mechanisms: &[Mechanism],
    free: &[Free],
    blocks: &[Track],
    noise: &[Noise],
) -> Result<Vec<usize>, Unstable> {
    let mut out = Vec::new();
    about.step = COARSE;
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
    about.step = STEP;
    Ok(out)
}

/// Whether the first fit frees the mechanism: gains, friction, rotor inertia, common delay and encoder offsets.
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
