//! Recordings of the simulated robot on which proofs and tests stand.
//!
//! - [`cases`]: sealed diagnosis cases with one withheld effect and their answers.
//! - `lag`: filters between a torque and its log.
//! - `effects`: what a sealed case can withhold, one file per effect.
//! - [`protocols`]: recordings as the source papers made theirs.
//! - [`channels`]: raw recordings whose torque came through a channel with one fault.
//! - [`raw`]: recordings as a controller logs them, with what is true of their torque channel.
#![forbid(unsafe_code)]

pub mod cases;
pub mod channels;
mod command_line;
mod effects;
mod error;
mod lag;
pub mod protocols;
pub mod raw;

pub use command_line::command_line;
pub use error::SimulateError;
pub use protocols::{Protocol, Simulated, cached};
