//! Fit of another set of mechanisms, started from the fit of the found set.

use super::Found;
use super::effort::{LAST, NEXT};
use super::free::{free, pinned, tolerated};
use super::neighbour;
use crate::arm::Arm;
use crate::fit::{Effort, Fitted, Free, Noise, descend, fit};
use crate::given::Given;
use crate::parameter::Parameter;
use crate::simulate::{Track, Unstable};
use crate::tracks::Replayed;

/// Arm fitted with the mechanisms `set`, a part of the found ones. Parameters of the others have their given values, for within
/// a tolerance a clear effect would still be fitted, and so have all that are not free. The fit starts from the found fit's
/// values, or from those that its expansion predicts, whichever has the lower objective.
///
/// # Errors
/// Simulator that is unstable.
pub fn refit(
    given: &Given,
    replayed: &Replayed,
    found: &Found,
    set: &[usize],
    effort: Effort,
) -> Result<Arm, Unstable> {
    let of = |m: &usize| {
        let own = found.mechanisms[*m].parameters.iter();
        own.map(|entry| entry.parameter)
    };
    let kept: Vec<Parameter> = set.iter().flat_map(of).collect();
    let gone: Vec<Parameter> = found.decision.set.iter().flat_map(of).collect();
    let mut always = tolerated(given, replayed);
    always.retain(|e| kept.contains(&e.parameter) || !gone.contains(&e.parameter));
    let free = free(given, &found.mechanisms, set, &always);
    let (blocks, noise) = (&replayed.blocks, &found.fitted.noise);
    let start = start(given, replayed, found, set, &free, effort);
    let start = pinned(given, &start, &free);
    Ok(descend(&start, &free, blocks, noise, effort, None)?.arm)
}

/// Arm from which the fit of another set starts: the search's own fit of that set, or one that is predicted from the
/// found fit.
fn start(
    given: &Given,
    replayed: &Replayed,
    found: &Found,
    set: &[usize],
    free: &[Free],
    effort: Effort,
) -> Arm {
    match found.around.iter().find(|n| n.set == set) {
        Some(neighbour) => neighbour.arm.clone(),
        None => {
            let blocks = &replayed.blocks;
            neighbour::start(given, &found.fitted, &found.free, free, blocks, effort)
        }
    }
}

/// Fit with the mechanisms `set` instead of the found ones, with its free parameters, as thorough as that of what is
/// decided. All tolerances stay free.
///
/// # Errors
/// The simulator as given is unstable.
pub fn refit_finely(
    given: &Given,
    replayed: &Replayed,
    found: &Found,
    set: &[usize],
) -> Result<(Vec<Free>, Fitted), Unstable> {
    let always = tolerated(given, replayed);
    let free = free(given, &found.mechanisms, set, &always);
    let (blocks, noise) = (&replayed.blocks, &found.fitted.noise);
    let start = start(given, replayed, found, set, &free, NEXT);
    let fitted = finely(&start, &free, blocks, noise)?;
    Ok((free, fitted))
}

/// Fit of these parameters as thorough as that of what is decided: at a long step first, then at that of what is scored.
///
/// # Errors
/// Arm at the start that is unstable.
pub fn finely(
    start: &Arm,
    free: &[Free],
    blocks: &[Track],
    noise: &[Noise],
) -> Result<Fitted, Unstable> {
    let start = descend(start, free, blocks, noise, NEXT, None)?.arm;
    fit(&start, free, blocks, noise, LAST, None)
}

/// Result of the search without its unknown torques, fitted again. No simulator can be given a torque without a name.
///
/// # Errors
/// The simulator as given is unstable.
pub fn named(given: &Given, replayed: &Replayed, found: &Found) -> Result<Found, Unstable> {
    let set = found.named();
    let mut out = found.clone();
    if set == found.decision.set {
        return Ok(out);
    }
    (out.free, out.fitted) = refit_finely(given, replayed, found, &set)?;
    let mut kept = found.decision.set.iter().map(|m| set.contains(m));
    out.decision.swaps.retain(|_| kept.next().unwrap_or(true));
    out.decision.set = set;
    Ok(out)
}
