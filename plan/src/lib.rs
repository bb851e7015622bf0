//! `feedforward`: the torque of a planned motion, for a controller to feed forward.
#![forbid(unsafe_code)]
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod arguments;
mod derive;
mod jump;
mod limits;
mod motion;
mod run;
mod torque;
mod unit;

use arguments::Arguments;
use clap::{CommandFactory, Parser};
use std::ffi::OsString;
use std::process::ExitCode;

/// The command line, as clap takes it.
pub fn command() -> clap::Command {
    Arguments::command()
}

/// Runs the program `feedforward` and returns its exit status. The first of the arguments is the name by which it was
/// called. `--help` and wrong usage end the process here, as clap does it.
pub fn command_line(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = Arguments::parse_from(arguments);
    match run::run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
