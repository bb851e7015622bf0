//! What happens to a recording before it is fitted: robot and columns, its check, its torque channel, its cut-off.

pub mod channel;
pub mod check;
pub mod choice;
pub mod cutoff;
pub mod doctor;
pub mod setup;
pub mod torque_band;
pub mod units;
pub mod wrapped;
