//! `train`: recordings to a model directory.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    train::command_line(std::env::args_os())
}
