//! `decoupled`: joints that move one at a time under their controller, after the COMAU paper.
#![forbid(unsafe_code)]
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod command;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Identification of single joints in closed loop: projection, instruments, likelihood; gravity and friction runs.
#[derive(Debug, Parser)]
#[command(name = "decoupled", version)]
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

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(e) => {
            let _ = e.print();
            return ExitCode::from(if e.use_stderr() { 2 } else { 0 });
        }
    };
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
