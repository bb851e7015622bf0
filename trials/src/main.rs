//! `simulate`: recordings of simulated robots.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    trials::command_line(std::env::args_os())
}
