//! `payload`: the body on a robot's last link, from a recording with it and a model without it.
#![forbid(unsafe_code)]
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod arguments;
mod run;
mod screen;

use arguments::Arguments;
use clap::{CommandFactory, Parser};
use std::ffi::OsString;
use std::process::ExitCode;

/// The command line, as clap takes it.
pub fn command() -> clap::Command {
    Arguments::command()
}

/// Runs the program `payload` with these arguments, of which the first is its name; returns the exit status.
/// `--help` and wrong usage end the process here, as clap does.
pub fn command_line(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = Arguments::parse_from(arguments);
    match run::run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
