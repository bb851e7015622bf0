//! The programs `diagnose` and `replay`, and their proof: sealed simulated cases, diagnosed and scored.
//!
//! The diagnoses themselves are the libraries `diagnose` and `replay`, which do not depend on the origin of their proof's cases.
#![forbid(unsafe_code)]

pub mod attainable;
mod command_line;
pub mod motion;
pub mod prove;

pub use command_line::{command, command_line};
