//! What stands between a model and the drives: limits, ramps, the caller's time.

use crate::code::{Code, Fault};
use crate::handle::{Model, with};
use crate::slices::{slices, usable};
use feedforward::guard::{Settings, Status};

/// A value of the motion or the time is not finite; the last torque is held.
pub const RESIDYN_BAD_INPUT: u32 = 1;
/// The model's torque is not finite; the last torque is held.
pub const RESIDYN_BAD_TORQUE: u32 = 2;
/// The time lies before that of the last tick; the last torque is held and time starts anew.
pub const RESIDYN_BACKWARD: u32 = 4;
/// Less than half a period after the last sample; the last torque is held.
pub const RESIDYN_STALE: u32 = 8;
/// A period or more passed without a tick.
pub const RESIDYN_LATE: u32 = 16;
/// An old torque stood for longer than it may: the torque goes to zero, until the next start.
pub const RESIDYN_OVERRUN: u32 = 32;
/// A torque was cut at its limit.
pub const RESIDYN_TORQUE_LIMITED: u32 = 64;
/// A torque was not let change so fast.
pub const RESIDYN_RATE_LIMITED: u32 = 128;
/// A position lies outside the robot's limits.
pub const RESIDYN_POSITION_OUTSIDE: u32 = 256;
/// A compensator is faded, for the motion lies outside its training.
pub const RESIDYN_FADED: u32 = 512;
/// A compensator is off, for the motion lies far outside its training.
pub const RESIDYN_UNCOMPENSATED: u32 = 1024;
/// The torque grows to the model's after a start.
pub const RESIDYN_STARTING: u32 = 2048;
/// The torque goes to zero after a stop.
pub const RESIDYN_STOPPING: u32 = 4096;
/// The torque is zero: before the first start, or after a stop.
pub const RESIDYN_STOPPED: u32 = 8192;

const _: () = {
    assert!(RESIDYN_BAD_INPUT == Status::BAD_INPUT.bits());
    assert!(RESIDYN_BAD_TORQUE == Status::BAD_TORQUE.bits());
    assert!(RESIDYN_BACKWARD == Status::BACKWARD.bits());
    assert!(RESIDYN_STALE == Status::STALE.bits());
    assert!(RESIDYN_LATE == Status::LATE.bits());
    assert!(RESIDYN_OVERRUN == Status::OVERRUN.bits());
    assert!(RESIDYN_TORQUE_LIMITED == Status::TORQUE_LIMITED.bits());
    assert!(RESIDYN_RATE_LIMITED == Status::RATE_LIMITED.bits());
    assert!(RESIDYN_POSITION_OUTSIDE == Status::POSITION_OUTSIDE.bits());
    assert!(RESIDYN_FADED == Status::FADED.bits());
    assert!(RESIDYN_UNCOMPENSATED == Status::UNCOMPENSATED.bits());
    assert!(RESIDYN_STARTING == Status::STARTING.bits());
    assert!(RESIDYN_STOPPING == Status::STOPPING.bits());
    assert!(RESIDYN_STOPPED == Status::STOPPED.bits());
};

/// How the caller has kept its period since the last start.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pace {
    /// Ticks whose time could be used.
    pub ticks: u64,
    /// Ticks that came a period late or more.
    pub late: u64,
    /// Periods that passed without a tick.
    pub missed: u64,
    /// Mean time from tick to tick, s.
    pub mean: f64,
    /// Longest time from tick to tick, s.
    pub longest: f64,
}

/// Sets settings that were changed by `change`.
///
/// # Safety
/// As [`with`].
unsafe fn set(
    model: *mut Model,
    change: impl FnOnce(&Model, &mut Settings) -> Result<(), Fault>,
) -> Code {
    // SAFETY: passed on.
    unsafe {
        with(model, |model, inner| {
            let mut settings = inner.guard.settings().clone();
            change(model, &mut settings)?;
            inner.guard.set(settings).map_err(|error| {
                crate::code::remember(&error.to_string());
                Fault(Code::ResidynValue, "")
            })
        })
    }
}

/// Sets the largest torque (N·m or N) and its fastest change (N·m/s or N/s) by joint; null leaves one as it is, infinity is none.
/// Before, the torque is limited as the robot's description says, and its change is not: a reference that jumps makes the torque jump.
/// Not for the loop: it allocates.
///
/// # Safety
/// `model` is null or a handle that was not freed; arrays are null or have `n` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_set_limits(
    model: *mut Model,
    torque: *const f64,
    rate: *const f64,
    n: usize,
) -> Code {
    // SAFETY: passed on.
    unsafe {
        set(model, |model, settings| {
            if n != model.joints() {
                return Err(Fault(
                    Code::ResidynLength,
                    "another number of limits than the model has joints",
                ));
            }
            for (given, list) in [(torque, &mut settings.torque), (rate, &mut settings.rate)] {
                if !given.is_null() {
                    usable(given)?;
                    list.copy_from_slice(std::slice::from_raw_parts(given, n));
                }
            }
            Ok(())
        })
    }
}

/// Sets the time of the ramps after start and stop (0.5 s before), and the longest time that an old torque may stand while the input
/// is bad or no tick comes (0.02 s before). Not for the loop: it allocates.
///
/// # Safety
/// `model` is null or a handle that was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_set_times(model: *mut Model, ramp: f64, hold: f64) -> Code {
    // SAFETY: passed on.
    unsafe {
        set(model, |_, settings| {
            settings.ramp = ramp;
            settings.hold = hold;
            Ok(())
        })
    }
}

/// Sets what the drive does by itself: by how much it is late (s, 0 before), for which the model is asked for the motion so much later;
/// and whether it adds gravity's torque (0, as before, or 1), which is then left out. Not for the loop: it allocates.
///
/// # Safety
/// `model` is null or a handle that was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_set_drive(
    model: *mut Model,
    delay: f64,
    adds_gravity: i32,
) -> Code {
    // SAFETY: passed on.
    unsafe {
        set(model, |_, settings| {
            settings.drive_delay = delay;
            settings.drive_adds_gravity = adds_gravity != 0;
            Ok(())
        })
    }
}

/// Lets the torque of residyn_tick grow from what was sent last (0 at first) to the model's.
///
/// # Safety
/// `model` is null or a handle that was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_start(model: *mut Model) -> Code {
    // SAFETY: passed on.
    unsafe {
        with(model, |_, inner| {
            inner.guard.start();
            Ok(())
        })
    }
}

/// Lets the torque of residyn_tick go from what was sent last to zero.
///
/// # Safety
/// `model` is null or a handle that was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_stop(model: *mut Model) -> Code {
    // SAFETY: passed on.
    unsafe {
        with(model, |_, inner| {
            inner.guard.stop();
            Ok(())
        })
    }
}

/// Torque `tau` to send at `time` (s, of a clock that does not jump) for the motion of this tick, within limits, whatever comes in:
/// `status` says by flags what happened. A value that is not finite is a flag here, not a code. Zero before residyn_start.
///
/// # Safety
/// `model` is null or a handle that was not freed; arrays are null or have `n` values; `status` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_tick(
    model: *mut Model,
    time: f64,
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
            usable(status)?;
            let ([q, qd, qdd], tau) = slices([q, qd, qdd], tau, n, model.joints(), n)?;
            status.write(inner.guard.tick(time, q, qd, qdd, tau).bits());
            Ok(())
        })
    }
}

/// How the caller of residyn_tick has kept its period since the last start.
///
/// # Safety
/// `model` is null or a handle that was not freed; `pace` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_pace_of(model: *mut Model, pace: *mut Pace) -> Code {
    // SAFETY: passed on.
    unsafe {
        with(model, |_, inner| {
            usable(pace)?;
            let seen = inner.guard.pace();
            pace.write(Pace {
                ticks: seen.ticks,
                late: seen.late,
                missed: seen.missed,
                mean: seen.mean,
                longest: seen.longest,
            });
            Ok(())
        })
    }
}
