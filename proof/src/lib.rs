//! The programs `diagnose` and `replay`, and the proof of what they say: sealed simulated cases, diagnosed and scored.
//!
//! The diagnoses themselves are the libraries `diagnose` and `replay`, which know nothing of where their proof's cases come from.
#![forbid(unsafe_code)]

mod command_line;
pub mod motion;
pub mod prove;

pub use command_line::command_line;
