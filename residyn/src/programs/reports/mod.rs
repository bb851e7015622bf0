//! `residyn report`: what is made of reports that `diagnose`, `replay` and `eval` have written.

mod comparison;
mod page;
mod read;
mod words;

use clap::{CommandFactory, Parser, Subcommand};
use comparison::{MismatchError, compare};
use read::ReadError;
use report::write::{OutputError, prepare};
use report::{WriteError, say, say_text, warn, write_atomic};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

/// Reports that `--json` of `diagnose`, `replay` and `eval` has written
#[derive(Parser)]
#[command(name = "report", version = program::VERSION)]
struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// Two runs of one program on one robot side by side: verdict, error by joint, causes with their sizes, what changed
    Compare {
        /// Report of the first run.
        #[arg(value_name = "A.json")]
        a: PathBuf,
        /// Report of the second run.
        #[arg(value_name = "B.json")]
        b: PathBuf,
        /// Write the comparison as a self-contained page.
        #[arg(long)]
        html: Option<PathBuf>,
    },
}

/// Why no comparison was made.
#[derive(Debug, thiserror::Error)]
enum CompareError {
    #[error(transparent)]
    Read(#[from] ReadError),
    #[error(transparent)]
    Mismatch(#[from] MismatchError),
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// The command line, as clap takes it.
pub fn command() -> clap::Command {
    Arguments::command()
}

/// Runs `residyn report` and returns its exit status. The first of the arguments is the name by which it was called.
pub fn command_line(arguments: Vec<OsString>) -> ExitCode {
    let What::Compare { a, b, html } = Arguments::parse_from(arguments).what;
    match run([a, b], html) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            warn!("error: {error}");
            ExitCode::from(if matches!(error, CompareError::Write(_)) {
                1
            } else {
                2
            })
        }
    }
}

fn run([a, b]: [PathBuf; 2], html: Option<PathBuf>) -> Result<(), CompareError> {
    prepare(&html)?;
    let compared = compare(read::read(&a)?, read::read(&b)?)?;
    for (name, run) in words::NAMES.iter().zip(&compared.runs) {
        say!("{name}: {}", run.path.display());
    }
    for line in words::lines(&compared) {
        say!("{line}");
    }
    let tables = words::errors(&compared).into_iter();
    let causes = words::causes(&compared).into_iter();
    for table in tables.chain(causes).chain(words::sizes(&compared)) {
        say_text!(format!("\n{}", table.to_text()));
    }
    if let Some(path) = &html {
        write_atomic(path, page::render(&compared))?;
        say!("");
        report::write::say_written([path]);
    }
    Ok(())
}
