//! `excite`: motions from which a robot's parameters can be identified, and the effects that a motion would show.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    excite::command_line(std::env::args_os())
}
