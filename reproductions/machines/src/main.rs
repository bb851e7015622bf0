//! `machine`: identifies, evaluates and simulates machines with torque models of their own: axes, SCARA, Delta, PUMA.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    machines::command_line(std::env::args_os())
}
