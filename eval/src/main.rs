//! `eval`: scores and predictions of a model directory on a recording.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    eval::command_line(std::env::args_os())
}
