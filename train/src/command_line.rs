//! Command line of `train`.

use crate::arguments::{Arguments, Command};
use crate::run::{Gpu, no_gpu, run_with};
use crate::{doctor, forward, oracle, runtime, study};
use clap::CommandFactory;
use std::ffi::OsString;
use std::process::ExitCode;

/// The command line, as clap takes it.
pub fn command() -> clap::Command {
    program::with_config(Arguments::command())
}

/// Runs the program `train` and returns its exit status. The first of the arguments is the name by which it was called.
/// `--help` and wrong usage end the process here, as clap does it.
pub fn command_line(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    command_line_with(arguments, no_gpu)
}

/// Runs the program as [`command_line`] does, with a GPU for `--gpu`.
pub fn command_line_with(arguments: impl IntoIterator<Item = OsString>, gpu: Gpu) -> ExitCode {
    let arguments: Arguments = program::parse(arguments);
    let result = runtime::interruptible().and_then(|cancel| match &arguments.command {
        None => run_with(&arguments, &cancel, &(), gpu),
        Some(Command::Study(study)) => study::run(study, &cancel),
        Some(Command::Oracle(oracle)) => oracle::run(oracle),
        Some(Command::Doctor(doctor)) => doctor::run(doctor, &cancel),
        Some(Command::Forward(forward)) => forward::run(forward, &cancel),
    });
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
