//! `machine`: identifies, evaluates and simulates machines with torque models of their own: axes, SCARA, Delta, PUMA.
#![forbid(unsafe_code)]
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod command;

use clap::{Parser, Subcommand};
use machines::MachineError;
use std::process::ExitCode;

/// Torque models of machines as a motion controller knows them: axes, SCARA, Delta, PUMA.
#[derive(Debug, Parser)]
#[command(name = "machine", version)]
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

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
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
