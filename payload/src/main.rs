//! `payload`: the body on a robot's last link, from a recording with it and a model without it.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    payload::command_line(std::env::args_os())
}
