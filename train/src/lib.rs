//! From recordings to a model directory: the steps of the program `train`, as a library.
#![forbid(unsafe_code)]
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod arguments;
mod checked;
mod checkpoint;
mod command_line;
pub mod doctor;
mod estimator;
pub mod forward;
mod inertia;
mod input;
pub mod oracle;
mod output;
mod periods;
mod progress;
mod run;
pub mod runtime;
mod screen;
pub mod study;
mod taught;
mod topics;
mod watch;
mod yardsticks;

pub use checked::{Checked, check};
pub use command_line::{command, command_line, command_line_with};
pub use compensator::training::Progress;
pub use run::{Gpu, run, run_with};
pub use watch::Watch;
