//! `train`: recordings to a model directory.
#![forbid(unsafe_code)]
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod arguments;
mod checkpoint;
mod estimator;
mod input;
mod output;
mod progress;
mod run;
mod runtime;
mod screen;
mod study;

use arguments::{Arguments, Command};
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(e) => {
            let _ = e.print();
            return ExitCode::from(if e.use_stderr() { 2 } else { 0 });
        }
    };
    let result = runtime::interruptible().and_then(|cancel| match &arguments.command {
        None => run::run(&arguments, &cancel),
        Some(Command::Study(study)) => study::run(study, &cancel),
    });
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
