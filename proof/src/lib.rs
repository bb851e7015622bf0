//! The program `diagnose`, and the proof of what it says: sealed simulated cases, diagnosed and scored.
//!
//! The diagnosis itself is the library `diagnose`, which knows nothing of where its proof's cases come from.
#![forbid(unsafe_code)]

mod command_line;
pub mod prove;

pub use command_line::command_line;
