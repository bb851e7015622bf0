//! `feedforward`: the torque of a planned motion.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    plan::command_line(std::env::args_os())
}
