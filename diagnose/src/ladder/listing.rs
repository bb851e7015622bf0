//! Listing: accepted causes that reduce the error on the part of the fitted recording that their fit did not see.
//!
//! The search compares sums over that part. Here each accepted cause is left out alone, the others kept, and
//! the fall of the error is bootstrapped over blocks of time. A cause whose interval contains zero is taken
//! back, the weakest first: of two that share a torque, each may be spared while the other stands. A cause that
//! a trace names by itself is kept.

use crate::catalogue::choice::Choice;
use crate::catalogue::effect::Effect;
use crate::input::frames::Frames;
use crate::ladder::out_of_fold::{OutOfFold, gain};
use crate::ladder::rungs::Free;
use crate::ladder::scores::{Scored, total};
use crate::search::find::{Findings, gap};
use crate::settings::Rule;
use crate::simulator::NominalModel;
use datasets::metrics::{Scope, deviations};
use ndarray::Array2;

/// Causes that are listed, from the fitted recording alone.
pub struct Listing {
    /// Index among the accepted causes, and joints, of each accepted cause of kind `structure`.
    pub structure: Vec<(usize, Vec<usize>)>,
    /// Changes of parameters that are listed, and their joints.
    pub parameters: Vec<(Effect, Vec<usize>)>,
    /// Residual of the last step out of fold at the recorded samples, shape (samples, joints).
    pub residual: Array2<f64>,
    /// Gap of the model as given: sum over joints of the squared NRMSE.
    pub given: f64,
    /// Coulomb friction in the last step's prediction, N·m, by joint.
    pub coulomb: Vec<f64>,
}

/// Takes back causes that do not pay, and determines the joints that the others touch. `weight` of the fitted
/// rows, shape (rows, joints); `scored` selects the samples that are judged, `effects` the effects that may be
/// listed. `moves` is false where there is hardly any motion to judge by.
pub fn list(
    model: &NominalModel,
    frames: &Frames,
    found: &mut Findings,
    weight: &Array2<f64>,
    scored: &Scored,
    effects: Choice,
    moves: bool,
) -> Listing {
    let gap = scored.judged(gap(model, &frames.data, &frames.scale));
    let unseen = OutOfFold::new(found, frames, &gap, weight);
    while !moves && !found.accepted.is_empty() {
        found.take_back(0, &frames.scale);
    }
    found.choose_freedom(model, &frames.scale);
    let causes = loop {
        let causes = left_out(model, frames, found, &unseen);
        let weakest = causes
            .iter()
            .filter(|c| c.interval[0] <= 0.0 && !found.by_trace(c.accepted))
            .min_by(|a, b| a.interval[0].total_cmp(&b.interval[0]));
        match weakest {
            Some(cause) => found.take_back(cause.accepted, &frames.scale),
            None => break causes,
        }
    };
    let structure: Vec<(usize, Vec<usize>)> =
        causes.into_iter().map(|c| (c.accepted, c.joints)).collect();
    let last = found.refit(model, &frames.scale, &found.structure(), Free::All);
    let mut parameters = if moves {
        parameters(model, frames, found, &unseen, scored, &structure)
    } else {
        Vec::new()
    };
    parameters.retain(|p| effects.holds(p.0));
    Listing {
        parameters,
        given: total(&scored.figures(&gap, &frames.data, Scope::All)),
        coulomb: found.coulomb(model, &last),
        residual: scored.judged(unseen.residual(&last)),
        structure,
    }
}

/// Gain of an accepted cause when it is left out alone.
struct LeftOut {
    accepted: usize,
    joints: Vec<usize>,
    interval: [f64; 2],
}

/// Gain of every accepted cause of kind `structure` when left out alone. Causes that free parameters could
/// absorb are left out of the fit near the given parameters, which are held. For all others the parameters are
/// fitted again without the cause.
fn left_out(
    model: &NominalModel,
    frames: &Frames,
    found: &Findings,
    unseen: &OutOfFold,
) -> Vec<LeftOut> {
    let structure = found.structure();
    if structure.is_empty() {
        return Vec::new();
    }
    let refit = |causes: &[usize]| {
        let fit = found.refit(model, &frames.scale, causes, Free::All);
        unseen.residual(&fit)
    };
    let after = unseen.losses(&refit(&structure));
    let tight = found.tight_fit(&frames.scale);
    let held = unseen.residual(&tight);
    let held_after = unseen.losses(&held);
    let one = |&c: &usize| {
        let own = found.accepted[c].variables.clone();
        let torque = unseen.torque(&tight, |i| own.contains(&i));
        let joints = touched(found, c, &torque, &held, frames);
        let (_, interval) = if found.candidate(c).effect.info().absorbable {
            gain(&unseen.losses(&(&held + &torque)), &held_after, &joints)
        } else {
            let others: Vec<usize> = structure.iter().copied().filter(|&o| o != c).collect();
            gain(&unseen.losses(&refit(&others)), &after, &joints)
        };
        LeftOut {
            accepted: c,
            joints,
            interval,
        }
    };
    structure.iter().map(one).collect()
}

/// Joints that a cause is reported for: its own. For an effect of the whole arm, the joints whose torque it changes noticeably.
fn touched(
    found: &Findings,
    cause: usize,
    torque: &Array2<f64>,
    residual: &Array2<f64>,
    frames: &Frames,
) -> Vec<usize> {
    let candidate = found.candidate(cause);
    let few = candidate.joints.len() < torque.ncols() || candidate.effect.info().late;
    if few && candidate.effect != Effect::Payload {
        return candidate.joints.clone();
    }
    let motion = frames.data.samples();
    let deviation = deviations(frames.data.tau.view(), motion.qd.view());
    let fall: Vec<f64> = (0..torque.ncols())
        .map(|j| {
            let Some(d) = deviation[j] else { return 0.0 };
            let (r, c) = (residual.column(j), torque.column(j));
            let fall = (2.0 * r.dot(&c) + c.dot(&c)) / r.len().max(1) as f64;
            fall.max(0.0).sqrt() / d
        })
        .collect();
    let most = fall.iter().copied().fold(0.0, f64::max);
    let noticed = found.settings.ladder.noticed;
    (0..fall.len())
        .filter(|&j| fall[j] > 0.0 && fall[j] >= noticed * most)
        .collect()
}

/// NRMSE by joint, and losses by block, then joint.
type Errors = (Vec<Option<f64>>, Vec<Vec<f64>>);

/// Fall of each joint's NRMSE by freeing parameters, where it is larger than by noise.
struct Falls {
    /// Fall of each joint's NRMSE by freeing the links' parameters, with friction fitted.
    links: Vec<f64>,
    /// Fall of each joint's NRMSE by freeing friction, with the links' parameters fitted.
    friction: Vec<f64>,
    /// Fall of each joint's NRMSE by freeing links' parameters and friction together.
    both: Vec<f64>,
    /// Fall of each joint's NRMSE by freeing links' parameters and friction together, without any cause of kind
    /// `structure`.
    alone: Vec<f64>,
}

impl Falls {
    /// Joints listed for their links, and joints listed for their friction. With `more`, a joint that needs
    /// both, or that re-identification alone helps and no cause explains, goes to the one that helps it more.
    fn listed(&self, least: f64, explained: &[bool], more: bool) -> [Vec<usize>; 2] {
        let mut listed = [Vec::new(), Vec::new()];
        for (j, explained) in explained.iter().enumerate() {
            let (links, friction) = (self.links[j], self.friction[j]);
            let needed = more && (self.both[j] >= least || self.alone[j] >= least && !explained);
            let neither = needed && links.max(friction) < least;
            if links >= least || neither && links >= friction {
                listed[0].push(j);
            }
            if friction >= least || neither && links < friction {
                listed[1].push(j);
            }
        }
        listed
    }
}

/// Parameter changes that lower a joint's error by a reportable amount, and by more than noise. Links and
/// friction are each held at the given values while all else is fitted. A joint that needs both, or that
/// re-identification alone helps, goes to the one that helps it more.
fn parameters(
    model: &NominalModel,
    frames: &Frames,
    found: &Findings,
    unseen: &OutOfFold,
    scored: &Scored,
    structure: &[(usize, Vec<usize>)],
) -> Vec<(Effect, Vec<usize>)> {
    let all = found.structure();
    let of = |causes: &[usize], free: Free| -> Errors {
        let fit = found.refit(model, &frames.scale, causes, free);
        let residual = unseen.residual(&fit);
        let nrmse = scored.figures(&residual, &frames.data, Scope::All).nrmse;
        (nrmse, unseen.losses(&residual))
    };
    let falls = |before: &Errors, after: &Errors| -> Vec<f64> {
        let fall = |j: usize| match (before.0[j], after.0[j]) {
            (Some(b), Some(a)) if gain(&before.1, &after.1, &[j]).1[0] > 0.0 => b - a,
            _ => 0.0,
        };
        (0..before.0.len()).map(fall).collect()
    };
    let full = of(&all, Free::All);
    let links = falls(&of(&all, Free::Friction), &full);
    let friction = falls(&of(&all, Free::Links), &full);
    let both = falls(&of(&all, Free::Nothing), &full);
    let alone = falls(&of(&[], Free::Nothing), &of(&[], Free::All));
    let explained = |j: usize| structure.iter().any(|(_, joints)| joints.contains(&j));
    let falls = Falls {
        links,
        friction,
        both,
        alone,
    };
    let explained: Vec<bool> = (0..falls.links.len()).map(explained).collect();
    let least = found.settings.ladder.listed;
    let plain = falls.listed(least, &explained, false);
    let mut listed = falls.listed(least, &explained, true);
    // A link that was found wrong by itself is named, however little of its torque is its own joint's.
    if !listed[0].is_empty() {
        let links = found
            .accepted
            .iter()
            .map(|a| &found.candidates[a.candidate]);
        let wrong = links.filter(|c| c.effect == Effect::LinkParameters);
        listed[0].extend(wrong.map(|c| c.joints[0]));
        listed[0].sort_unstable();
        listed[0].dedup();
    }
    let off = &found.settings.search.off;
    if !off.applies(Rule::Listed, listed != plain) {
        listed = plain;
    }
    [Effect::LinkParameters, Effect::FrictionParameters]
        .into_iter()
        .zip(listed)
        .filter(|(_, joints)| !joints.is_empty())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_listed_by_what_their_freedom_spares() {
        let falls = Falls {
            links: vec![0.05, 0.0, 0.015, 0.0, 0.0, 0.0],
            friction: vec![0.0, 0.03, 0.010, 0.0, 0.0, 0.0],
            both: vec![0.05, 0.03, 0.040, 0.0, 0.0, 0.0],
            alone: vec![0.05, 0.03, 0.040, 0.1, 0.1, 0.01],
        };
        let explained = [false, false, false, false, true, false];
        // Joint 2 needs both and goes to its links; nothing but identification helps joint 3, where a tie is the links'. A cause explains joint 4.
        let [links, friction] = falls.listed(0.02, &explained, true);
        assert_eq!(links, [0, 2, 3]);
        assert_eq!(friction, [1]);
        let [links, friction] = falls.listed(0.02, &explained, false);
        assert_eq!((links, friction), (vec![0], vec![1]));
    }
}
