//! `train`: recordings to a model directory.
#![forbid(unsafe_code)]

use clap::Parser;
use std::process::ExitCode;
use train::arguments::{Arguments, Command};
use train::{oracle, run, runtime, study};

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(e) => {
            let _ = e.print();
            return ExitCode::from(if e.use_stderr() { 2 } else { 0 });
        }
    };
    let result = runtime::interruptible().and_then(|cancel| match &arguments.command {
        None => run(&arguments, &cancel, None),
        Some(Command::Study(study)) => study::run(study, &cancel),
        Some(Command::Oracle(oracle)) => oracle::run(oracle),
    });
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
