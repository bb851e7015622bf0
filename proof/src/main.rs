//! `diagnose`: location and causes of the gap between a simulator and a real robot.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    proof::command_line(std::env::args_os())
}
