//! Friction by direction from runs of bang-bang acceleration (COMAU paper, section 3.2.2).

use crate::DecoupledError;
use crate::estimators::{Estimate, Estimator, Instruments};
use crate::gravity::Gravity;
use crate::joint::Columns;
use crate::run::Run;

/// Inertia and friction (Γ, β^{v+}, β^{v−}, β^{c+}, β^{c−}) of a run whose acceleration switches between two values: inertia
/// opens a loop between gathering way and losing it, which is what tells it from friction. `gravity` is taken off.
///
/// # Errors
/// A run that does not tell them.
pub fn of(run: &Run, gravity: Option<&Gravity>) -> Result<Estimate, DecoupledError> {
    let known = |k: usize| gravity.map_or(0.0, |g| g.torque(run.q[k]));
    Instruments.estimate(run, Columns { gravity: false }, &known)
}
