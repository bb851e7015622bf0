//! Command line of the program `replay`, with the subcommands of its proof.
#![deny(clippy::print_stdout, clippy::print_stderr)]

use super::{MotionError, Score, calibration, diagnosis, kinds, misses, prove, rates, score};
use clap::{CommandFactory, Parser, Subcommand};
use indicatif::ProgressBar;
use program::Running;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

/// Replays recorded commands on a robot's simulator: where its motion departs from the recorded one, which effect causes
/// it, and how far it shrinks once that effect is added. No torque is needed.
#[derive(Parser)]
#[command(name = "replay", version = program::VERSION, args_conflicts_with_subcommands = true)]
struct Command {
    /// Another job than a diagnosis.
    #[command(subcommand)]
    proof: Option<Proof>,
    /// The diagnosis.
    #[command(flatten)]
    arguments: Option<diagnosis::Arguments>,
    /// Threads and what is printed.
    #[command(flatten)]
    running: Running,
}

#[derive(Subcommand)]
enum Proof {
    /// Diagnoses sealed simulated cases with a withheld effect, and scores the answers.
    Prove {
        /// Number of cases.
        #[arg(long, default_value_t = 26)]
        cases: u64,
        /// Seed of the draw.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Largest number of joints of an arm.
        #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u64).range(3..=7))]
        joints: u64,
        /// Folder for cases and reports. What is there already is kept.
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Diagnoses and scores the cases of a folder, by whatever simulator: cases/NAME with a description, perhaps a drive.toml,
    /// train.parquet and test.parquet, and truth/NAME.json. Reports that are there already are scored as they are.
    Score {
        /// The folders.
        #[arg(required = true)]
        folders: Vec<PathBuf>,
    },
}

/// The command line, as clap takes it.
pub fn command() -> clap::Command {
    program::with_config(Command::command())
}

/// Runs the program `replay` and returns its exit status. The first of the arguments is the name by which it was
/// called. `--help` and wrong usage end the process here, as clap does it.
pub fn command_line(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let command: Command = program::parse(arguments);
    match (command.proof, command.arguments) {
        (Some(proof), _) => match run(proof) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                report::warn!("error: {error}");
                ExitCode::from(match error {
                    MotionError::Write(_) | MotionError::Recording(_) => 1,
                    _ => 2,
                })
            }
        },
        (None, Some(arguments)) => diagnosis::run(&arguments, &command.running),
        (None, None) => {
            report::warn!("error: --robot, --data and --heldout are needed; see --help");
            ExitCode::from(2)
        }
    }
}

/// Runs a subcommand of the proof and prints the tables of its scores.
fn run(proof: Proof) -> Result<(), MotionError> {
    let bar = ProgressBar::new(0);
    let scores = match proof {
        Proof::Prove {
            cases,
            seed,
            joints,
            out,
        } => {
            bar.set_length(cases);
            let temporary = tempfile::tempdir();
            let temporary = temporary.map_err(|e| MotionError::file(&std::env::temp_dir(), e))?;
            let folder = out.unwrap_or_else(|| temporary.path().to_owned());
            prove(cases, seed, joints as usize, &folder, |_| bar.inc(1))?
        }
        Proof::Score { folders } => {
            let mut all = Vec::new();
            for folder in &folders {
                all.extend(score(folder, |_| bar.inc(1))?);
            }
            all
        }
    };
    bar.finish_and_clear();
    say(&scores);
    Ok(())
}

/// Prints the tables of the scores.
fn say(scores: &[Score]) {
    report::say!("{}", kinds(scores).to_text());
    report::say!("{}", rates(scores).to_text());
    report::say!("{}", misses(scores).to_text());
    let (table, tempering) = calibration(scores);
    report::say!("{}", table.to_text());
    if let Some(power) = tempering {
        report::say!("Odds to the power of {power:.2} would be right as often as they say.");
    }
}
