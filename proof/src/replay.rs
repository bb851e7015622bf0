//! `replay`: location and causes of the difference between a simulator's motion and the robot's under the same commands.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    proof::motion::command_line(std::env::args_os())
}
