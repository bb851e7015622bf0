//! `decoupled`: joints that move one at a time under their controller, after the COMAU paper.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    decoupled::command_line(std::env::args_os())
}
