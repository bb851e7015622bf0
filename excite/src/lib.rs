//! `excite`: motions from which a robot's parameters can be identified, and the effects that a motion would show.
#![forbid(unsafe_code)]
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod arguments;
mod columns;
mod commands;
mod design;
mod failure;
mod judged;
mod limits;
mod motion;
mod page;
mod plan;
mod run;
mod screen;
mod summary;

use arguments::Arguments;
use clap::{CommandFactory, Parser};
use std::ffi::OsString;
use std::process::ExitCode;

/// The command line, as clap takes it.
pub fn command() -> clap::Command {
    Arguments::command()
}

/// Runs the program `excite` with these arguments, of which the first is its name; returns the exit status.
/// `--help` and wrong usage end the process here, as clap does.
pub fn command_line(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = Arguments::parse_from(arguments);
    match run::run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
