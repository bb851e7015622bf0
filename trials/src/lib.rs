//! Recordings of the simulated robot for proofs and tests.
//!
//! - [`cases`]: sealed diagnosis cases with one withheld effect and their answers.
//! - `lag`: filters between a torque and its log.
//! - `effects`: effects that a sealed case can withhold, one file per effect.
//! - [`protocols`]: recordings by the procedures of the source papers.
//! - [`channels`]: raw recordings whose torque came through a channel with one fault.
//! - [`raw`]: recordings in the form of a controller's log, with the truth about their torque channel.
#![forbid(unsafe_code)]

pub mod cases;
pub mod channels;
mod command_line;
mod effects;
mod error;
pub mod lag;
pub mod protocols;
pub mod raw;

pub use command_line::{command, command_line};
pub use error::SimulateError;
pub use protocols::{Protocol, Simulated, cached};
