//! `simulate`: recordings of simulated robots.

use clap::{Parser, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};
use simulate::{SimulateError, cases};
use std::path::PathBuf;
use std::process::ExitCode;

/// Recordings of simulated robots, with effects that a rigid-body model lacks.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    #[command(subcommand)]
    what: What,
    /// Threads (0: all).
    #[arg(long, global = true, default_value_t = 0)]
    threads: usize,
    /// No progress bar.
    #[arg(long, global = true)]
    quiet: bool,
}

#[derive(Subcommand)]
enum What {
    /// Sealed cases for `diagnose`: robot.urdf, train.parquet and test.parquet for each, and truth/ID.json.
    Cases {
        /// Folder to write into.
        #[arg(long)]
        out: PathBuf,
        /// Number of cases.
        #[arg(long, default_value_t = cases::ROUND)]
        cases: u64,
        /// Seed of the run.
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads)
        .build();
    let result = match pool {
        Ok(pool) => pool.install(|| run(&arguments)),
        Err(error) => {
            eprintln!("simulate: cannot start threads: {error}");
            return ExitCode::FAILURE;
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("simulate: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), SimulateError> {
    match &arguments.what {
        What::Cases { out, cases, seed } => {
            let bar = bar(*cases, arguments.quiet);
            cases::write_all(*cases, *seed, out, |id, _| {
                bar.set_message(id.to_owned());
                bar.inc(1);
            })?;
            bar.finish_with_message(format!("written to {}", out.display()));
            Ok(())
        }
    }
}

fn bar(length: u64, quiet: bool) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} (left {eta}) {msg}");
    ProgressBar::new(length).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
