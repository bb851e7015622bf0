//! The rigid body of a model, with the rotors of its drives.

use crate::code::{Code, Fault};
use crate::handle::{Model, with};
use crate::slices::{finite, slices};
use feedforward::Dynamics;

/// Runs `step` on inputs of `n` values and an output of `room`.
///
/// # Safety
/// `model` is null or a handle that was not freed; arrays are null or have as many values.
unsafe fn call<const I: usize>(
    model: *mut Model,
    inputs: [*const f64; I],
    output: *mut f64,
    n: usize,
    square: bool,
    step: impl FnOnce(&mut Dynamics, [&[f64]; I], &mut [f64]),
) -> Code {
    // SAFETY: passed on.
    unsafe {
        with(model, |model, inner| {
            let joints = model.joints();
            let room = if square { joints * joints } else { joints };
            let (inputs, output) = slices(inputs, output, n, joints, room)?;
            finite(&inputs)?;
            step(inner.guard.model_mut().dynamics(), inputs, output);
            if output.iter().all(|v| v.is_finite()) {
                return Ok(());
            }
            Err(Fault(Code::ResidynNotFinite, "the result is not finite"))
        })
    }
}

/// Torque `tau` of the rigid body with its rotors (N·m or N) for a motion: no friction, springs or compensator. No memory: it may be
/// called at any time, for any motion.
///
/// # Safety
/// `model` is null or a handle that was not freed; arrays are null or have `n` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_inverse_dynamics(
    model: *mut Model,
    q: *const f64,
    qd: *const f64,
    qdd: *const f64,
    tau: *mut f64,
    n: usize,
) -> Code {
    // SAFETY: passed on.
    unsafe {
        call(
            model,
            [q, qd, qdd],
            tau,
            n,
            false,
            |body, [q, qd, qdd], tau| {
                body.inverse(q, qd, qdd, tau);
            },
        )
    }
}

/// Torque `tau` that holds the rigid body at `q` against gravity, N·m or N.
///
/// # Safety
/// `model` is null or a handle that was not freed; arrays are null or have `n` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_gravity(
    model: *mut Model,
    q: *const f64,
    tau: *mut f64,
    n: usize,
) -> Code {
    // SAFETY: passed on.
    unsafe {
        call(model, [q], tau, n, false, |body, [q], tau| {
            body.gravity(q, tau)
        })
    }
}

/// Mass matrix of the rigid body with its rotors at `q`: n × n values, symmetric, row by row. Of parameters as identified: positive
/// definite for certain only where they were held to possible bodies (train --lmi last).
///
/// # Safety
/// `model` is null or a handle that was not freed; `q` is null or has `n` values, `matrix` is null or has n × n.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_mass_matrix(
    model: *mut Model,
    q: *const f64,
    matrix: *mut f64,
    n: usize,
) -> Code {
    // SAFETY: passed on.
    unsafe {
        call(model, [q], matrix, n, true, |body, [q], m| {
            body.mass_matrix(q, m)
        })
    }
}

/// Acceleration `qdd` of the rigid body with its rotors under `tau`, from which friction and the rest were taken off. By the matrix of
/// residyn_mass_matrix: a negative inertia turns the acceleration round.
///
/// # Safety
/// `model` is null or a handle that was not freed; arrays are null or have `n` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_forward_dynamics(
    model: *mut Model,
    q: *const f64,
    qd: *const f64,
    tau: *const f64,
    qdd: *mut f64,
    n: usize,
) -> Code {
    // SAFETY: passed on.
    unsafe {
        call(
            model,
            [q, qd, tau],
            qdd,
            n,
            false,
            |body, [q, qd, tau], qdd| {
                body.forward(q, qd, tau, qdd);
            },
        )
    }
}
