//! Preparation of a recording for a fit: robot and columns, check, torque channel, cut-off.

pub mod channel;
pub mod check;
pub mod choice;
pub mod cutoff;
pub mod doctor;
pub mod setup;
pub mod torque_band;
pub mod units;
pub mod wrapped;
