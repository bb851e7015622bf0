//! `residyn`: every program under one name.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    residyn::programs::command_line(std::env::args_os())
}
