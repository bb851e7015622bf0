//! `residyn demo`: a simulated arm whose description lacks a body and friction, diagnosed from two recordings.

use clap::{CommandFactory, Parser};
use report::{say, warn};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use trials::protocols::demo::demo;

/// Seed of motion and noise.
const SEED: u64 = 1;

/// A first look, in under a minute: simulates a UR5 that carries 1.2 kg and rubs more than its URDF says, and finds both
#[derive(Parser)]
#[command(name = "demo", version = program::VERSION)]
struct Arguments {
    /// Folder for recordings, report and corrected model.
    #[arg(long, default_value = "residyn-demo")]
    out: PathBuf,
}

/// The command line, as clap takes it.
pub fn command() -> clap::Command {
    Arguments::command()
}

/// Runs the demo and returns its exit status. The first of the arguments is the name by which it was called.
pub fn command_line(arguments: Vec<OsString>) -> ExitCode {
    let Arguments { out } = Arguments::parse_from(arguments);
    say!(
        "A UR5 is simulated on two days. It carries 1.2 kg, and two joints rub more than its URDF says."
    );
    if let Err(error) = demo(SEED).and_then(|made| made.write(&out)) {
        warn!("error: {error}");
        return ExitCode::from(1);
    }
    let diagnose = diagnosis(&out);
    let words: Vec<_> = diagnose.iter().map(|word| word.to_string_lossy()).collect();
    say!(
        "The diagnosis sees the URDF and the recordings alone:\n\n    {}\n",
        words.join(" ")
    );
    let ended = proof::command_line(diagnose);
    say!("\nThe report is {}.", out.join("gap.html").display());
    ended
}

/// The command that diagnoses what lies in `folder`.
fn diagnosis(folder: &Path) -> Vec<OsString> {
    let mut command: Vec<OsString> = vec!["residyn diagnose".into()];
    let files = [
        ("--robot", "robot.urdf"),
        ("--data", "monday.parquet"),
        ("--heldout", "friday.parquet"),
        ("--html", "gap.html"),
        ("--patch", "corrected.urdf"),
    ];
    for (option, file) in files {
        command.push(option.into());
        command.push(folder.join(file).into());
    }
    command
}
