//! C interface of the run-time: `libresidyn`, with `residyn.h` written from here and `residyn.hpp` over it.
//!
//! Every call returns a [`Code`]. Nothing unwinds or aborts across the border: a panic is a code, and its handle is of no use
//! afterwards. Pointers are looked at before they are used: null, unaligned or overlapping ones are codes, and so is a wrong number
//! of values. What cannot be seen is the caller's promise: a pointer that is not null points to as many values as it says.
//!
//! Calls of the loop do not allocate, take no lock and wait for nothing.
// The border itself: pointers come from C.
#![allow(unsafe_code)]

mod code;
mod dynamics;
mod guard;
mod handle;
mod load;
mod slices;
mod torque;

pub use code::{Code, residyn_last_error};
pub use dynamics::{
    residyn_forward_dynamics, residyn_gravity, residyn_inverse_dynamics, residyn_mass_matrix,
};
pub use guard::{
    Pace, RESIDYN_BACKWARD, RESIDYN_BAD_INPUT, RESIDYN_BAD_TORQUE, RESIDYN_FADED, RESIDYN_LATE,
    RESIDYN_OVERRUN, RESIDYN_POSITION_OUTSIDE, RESIDYN_RATE_LIMITED, RESIDYN_STALE,
    RESIDYN_STARTING, RESIDYN_STOPPED, RESIDYN_STOPPING, RESIDYN_TORQUE_LIMITED,
    RESIDYN_UNCOMPENSATED, residyn_pace_of, residyn_set_drive, residyn_set_limits,
    residyn_set_times, residyn_start, residyn_stop, residyn_tick,
};
pub use handle::{
    Model, residyn_clone, residyn_free, residyn_is_compensated, residyn_joint_name, residyn_joints,
    residyn_period,
};
pub use load::{
    RESIDYN_ABI, residyn_abi, residyn_load_for, residyn_load_memory_for, residyn_version,
};
pub use torque::{
    residyn_compensator, residyn_friction, residyn_pause, residyn_range, residyn_reset,
    residyn_torque,
};
