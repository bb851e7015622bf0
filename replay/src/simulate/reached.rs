//! What drives reach in a simulated motion.

use super::{State, Track, Unstable, run};
use crate::arm::Arm;
use crate::parameter::Kind;
use rayon::prelude::*;

/// Largest magnitude, N·m (N), that each drive reaches while it follows `tracks`: of what limits of the kind `limit` bound,
/// which is the control output or the torque.
///
/// # Errors
/// Drive that is too stiff or unstable.
pub fn reached(arm: &Arm, tracks: &[Track], limit: Kind) -> Result<Vec<f64>, Unstable> {
    let now = |state: &State<'_>, j: usize| match limit {
        Kind::DriveLimit => state.drives[j].wanted.abs().min(arm.servos[j].drive_limit),
        _ => state.drives[j].transmitted.abs(),
    };
    let largest = |mut all: Vec<f64>, own: &dyn Fn(usize) -> f64| {
        all.iter_mut()
            .enumerate()
            .for_each(|(j, l)| *l = l.max(own(j)));
        all
    };
    let none = || vec![0.0; arm.dof()];
    let of = |track: &Track| -> Result<Vec<f64>, Unstable> {
        let mut out = none();
        run(arm, track, &[], &mut |_, state| {
            out = largest(std::mem::take(&mut out), &|j| now(state, j));
        })?;
        Ok(out)
    };
    let each: Vec<Vec<f64>> = tracks.par_iter().map(of).collect::<Result<_, _>>()?;
    Ok(each
        .iter()
        .fold(none(), |all, own| largest(all, &|j| own[j])))
}
