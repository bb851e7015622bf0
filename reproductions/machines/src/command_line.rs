//! Command line of `machine`.
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

use crate::MachineError;
// The module alone: the function `command` below has its name.
use crate::command::{self};
use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::OsString;
use std::process::ExitCode;

/// Torque models of machines as a motion controller knows them: axes, SCARA, Delta, PUMA.
#[derive(Debug, Parser)]
#[command(name = "machine", version = program::VERSION)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Built-in machines, their axes and parameters.
    List(command::list::Arguments),
    /// Parameters of a machine from a recording, with errors, success and what explains a poor result.
    Identify(command::identify::Arguments),
    /// Scores and predictions of an identified machine on a recording.
    Eval(command::eval::Arguments),
    /// A body on the last axis, from a recording with it and an identified machine without it.
    Payload(command::payload::Arguments),
    /// Recordings of a simulated machine: one to identify with, one to judge by.
    Simulate(command::simulate::Arguments),
}

/// The command line, as clap takes it.
pub fn command() -> clap::Command {
    Arguments::command()
}

/// What the program `machine` does with these arguments, of which the first is what it was called by; its exit status.
/// `--help` and wrong usage end the process here, as clap has it.
pub fn command_line(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let result = match Arguments::parse_from(arguments).command {
        Command::List(arguments) => command::list::run(&arguments),
        Command::Identify(arguments) => command::identify::run(&arguments),
        Command::Eval(arguments) => command::eval::run(&arguments),
        Command::Payload(arguments) => command::payload::run(&arguments),
        Command::Simulate(arguments) => command::simulate::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            report::warn!("error: {error}");
            if let Some(hint) = hint(&error) {
                report::warn!("hint: {hint}");
            }
            ExitCode::from(if error.is_input() { 2 } else { 1 })
        }
    }
}

/// What to do where the message does not say it.
fn hint(error: &MachineError) -> Option<&'static str> {
    match error {
        MachineError::Unknown { .. } => Some(
            "Give the path of a description (machine list --toml NAME prints one to start from); serial chains go to train --robot.",
        ),
        MachineError::Description { .. } => {
            Some("machine list --toml NAME prints a built-in description to compare with.")
        }
        MachineError::Read { .. } => Some("Check the path and its permissions."),
        _ => None,
    }
}
