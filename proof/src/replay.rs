//! `replay`: where a simulator's motion departs from the robot's under the same commands, and what causes it.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    proof::motion::command_line(std::env::args_os())
}
