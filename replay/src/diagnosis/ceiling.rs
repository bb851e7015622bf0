//! How little the listed causes could leave at all: a fit to the scored motion itself.

use crate::decide::{Found, finely};
use crate::fit::noise;
use crate::score::{Figures, figures, roll_out};
use crate::simulate::Unstable;
use crate::tracks::Replayed;

/// Errors on `heldout` of the found simulator with its free parameters fitted to `heldout` itself: no values of them leave much
/// less. The priors are those of the fit to other recordings.
///
/// # Errors
/// The found simulator is unstable in that motion.
pub(super) fn ceiling(found: &Found, heldout: &Replayed) -> Result<Figures, Unstable> {
    let floors: Vec<f64> = found.fitted.noise.iter().map(|n| n.floor).collect();
    let noise = noise(&found.fitted.arm, &heldout.blocks, &floors)?;
    let (start, free) = (&found.fitted.arm, &found.free);
    let arm = finely(start, free, &heldout.blocks, &noise)?.arm;
    Ok(figures(&roll_out(&arm, heldout)?, heldout))
}
