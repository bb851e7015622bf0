//! Command line of `decoupled`.
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

// The module alone: the function `command` below has its name.
use crate::command::{self};
use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::OsString;
use std::process::ExitCode;

/// Identification of single joints in closed loop: projection, instruments, likelihood; gravity and friction runs.
#[derive(Debug, Parser)]
#[command(name = "decoupled", version = program::VERSION)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Parameters of one joint from a periodic run, by every estimator side by side.
    Identify(command::identify::Arguments),
    /// Gravity from a run at constant speed, and friction by direction from one of bang-bang acceleration.
    Friction(command::friction::Arguments),
    /// The three runs of one simulated COMAU axis, as recordings.
    Simulate(command::simulate::Arguments),
    /// Biases of every estimator over simulated draws of all six axes, and the paper's tables beside ours.
    Study(command::study::Arguments),
    /// The identified model judged on trapezoids, and in the loop against the controller alone.
    Control(command::control::Arguments),
}

/// The command line, as clap takes it.
pub fn command() -> clap::Command {
    Arguments::command()
}

/// What the program `decoupled` does with these arguments, of which the first is what it was called by; its exit status.
/// `--help` and wrong usage end the process here, as clap has it.
pub fn command_line(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = Arguments::parse_from(arguments);
    let result = match arguments.command {
        Command::Identify(arguments) => command::identify::run(&arguments),
        Command::Friction(arguments) => command::friction::run(&arguments),
        Command::Simulate(arguments) => command::simulate::run(&arguments),
        Command::Study(arguments) => command::study::run(&arguments),
        Command::Control(arguments) => command::control::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            report::warn!("error: {error}");
            ExitCode::from(if error.is_input() { 2 } else { 1 })
        }
    }
}
