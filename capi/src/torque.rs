//! The model's torque, and what it is made of.

use crate::code::{Code, Fault};
use crate::handle::{Model, with};
use crate::slices::{finite, slices, usable};

/// Forgets friction memory and windows. `clock` is the time of the next sample on the clock of the training recordings, s, where this
/// loop continues it; NaN where it is not known.
///
/// # Safety
/// `model` is null or a handle that was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_reset(model: *mut Model, clock: f64) -> Code {
    // SAFETY: passed on.
    unsafe {
        with(model, |_, inner| {
            let clock = Some(clock).filter(|c| c.is_finite());
            inner.guard.model_mut().reset(clock);
            Ok(())
        })
    }
}

/// Starts a new trajectory `seconds` after the last sample: friction memory and clock run on, windows start anew.
///
/// # Safety
/// `model` is null or a handle that was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_pause(model: *mut Model, seconds: f64) -> Code {
    // SAFETY: passed on.
    unsafe {
        with(model, |_, inner| {
            if !(seconds >= 0.0 && seconds.is_finite()) {
                return Err(Fault(Code::ResidynValue, "a pause is no time"));
            }
            inner.guard.model_mut().pause(seconds);
            Ok(())
        })
    }
}

/// Torque `tau` of all `n` joints (N·m or N) for the motion of this control period, base first: rad or m, per s, per s². `status` gets
/// RESIDYN_FADED, RESIDYN_UNCOMPENSATED and RESIDYN_POSITION_OUTSIDE, or is null. No limits: residyn_tick has them.
///
/// The torque is that of residyn_inverse_dynamics, residyn_friction and residyn_compensator, and a rest that no call gives: each joint's
/// constant offset and, where the model has them, ripple, springs, counterbalance and coupling.
///
/// Where a value is not finite, `tau` stays as it was, and the period has passed without a sample.
///
/// # Safety
/// `model` is null or a handle that was not freed; arrays are null or have `n` values; `status` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_torque(
    model: *mut Model,
    q: *const f64,
    qd: *const f64,
    qdd: *const f64,
    tau: *mut f64,
    n: usize,
    status: *mut u32,
) -> Code {
    // SAFETY: passed on.
    unsafe {
        with(model, |model, inner| {
            let joints = model.joints();
            let ([q, qd, qdd], tau) = slices([q, qd, qdd], tau, n, joints, n)?;
            if let Err(fault) = finite(&[q, qd, qdd]) {
                inner.guard.model_mut().miss(1);
                return Err(fault);
            }
            inner
                .guard
                .model_mut()
                .torque(q, qd, qdd, &mut inner.scratch);
            if finite(&[&inner.scratch]).is_err() {
                return Err(Fault(
                    Code::ResidynNotFinite,
                    "the model's torque is not finite",
                ));
            }
            tau.copy_from_slice(&inner.scratch);
            if !status.is_null() {
                usable(status)?;
                status.write(inner.guard.remarks(q).bits());
            }
            Ok(())
        })
    }
}

/// What of the last torque was friction, N·m or N, by joint, without the joint's constant offset.
///
/// # Safety
/// `model` is null or a handle that was not freed; `tau` is null or has `n` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_friction(model: *mut Model, tau: *mut f64, n: usize) -> Code {
    // SAFETY: passed on.
    unsafe {
        with(model, |model, inner| {
            let ([], tau) = slices([], tau, n, model.joints(), n)?;
            tau.copy_from_slice(inner.guard.model().friction());
            Ok(())
        })
    }
}

/// What of the last torque was the compensator's, N·m or N, by joint; zero without one.
///
/// # Safety
/// `model` is null or a handle that was not freed; `tau` is null or has `n` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_compensator(model: *mut Model, tau: *mut f64, n: usize) -> Code {
    // SAFETY: passed on.
    unsafe {
        with(model, |model, inner| {
            let ([], tau) = slices([], tau, n, model.joints(), n)?;
            match inner.guard.model().compensation() {
                Some(share) => tau.copy_from_slice(share),
                None => tau.fill(0.0),
            }
            Ok(())
        })
    }
}

/// How far the last sample lay outside the compensator's training, by joint: the largest part of an input's span, or of the largest
/// distance of training, that it lies beyond. Zero or less inside: an input that sits at the edge of its training, such as a friction
/// state at its limit, makes it zero, and most samples have one. The compensator fades from 0.1 to 0.6. A sample is one of
/// residyn_torque or residyn_tick, before the start and after a stop as well; residyn_reset leaves the value. Minus infinity before
/// the first sample, and where nothing was learned.
///
/// # Safety
/// `model` is null or a handle that was not freed; `excess` is null or has `n` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_range(model: *mut Model, excess: *mut f64, n: usize) -> Code {
    // SAFETY: passed on.
    unsafe {
        with(model, |model, inner| {
            let ([], excess) = slices([], excess, n, model.joints(), n)?;
            for (joint, excess) in excess.iter_mut().enumerate() {
                *excess = inner.guard.model().inside(joint).excess.into();
            }
            Ok(())
        })
    }
}
