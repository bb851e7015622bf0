//! Runs of `diagnose` on small recordings.

mod case;
mod command_line;
mod mjcf;
mod model_directory;
mod next_motion;
mod robots;
mod score;
mod sensors;
#[path = "../../../tests/src/shared.rs"]
mod shared;
mod visibility;
