//! `diagnose`: where the gap between a simulator and a real robot lies, and what causes it.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    proof::command_line(std::env::args_os())
}
