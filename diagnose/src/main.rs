//! `diagnose`: where the gap between a simulator and a real robot lies, and what causes it.
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod arguments;

use arguments::{Arguments, Command, Proof};
use clap::Parser;
use diagnose::directory::{self, Directory};
use diagnose::{
    DiagnoseError, Given, Options, Outcome, budget, diagnose, next_motion, page, patch, prove,
    words,
};
use indicatif::ProgressBar;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// Surrogates of a recording: the least chance that they can tell is one in 200.
const SURROGATES: u64 = 199;

fn main() -> ExitCode {
    let command = Command::parse();
    match (command.proof, command.arguments) {
        (Some(proof), _) => match run_proof(&proof) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                report::warn!("error: {error}");
                ExitCode::FAILURE
            }
        },
        (None, Some(arguments)) => match run(&arguments) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                report::warn!("error: {error}");
                ExitCode::from(if error.is_input() { 2 } else { 1 })
            }
        },
        (None, None) => {
            report::warn!("error: --robot or --model, --data and --heldout are needed; see --help");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), DiagnoseError> {
    let drive = arguments.drive.as_deref();
    let mut given = match (&arguments.robot, &arguments.model) {
        (Some(robot), _) => Given::robot(robot, drive, arguments.gravity)?,
        (None, Some(directory)) => Given::model(directory, drive)?,
        (None, None) => unreachable!("the command line demands one of them"),
    };
    let spinner = ProgressBar::new_spinner().with_message("reading");
    spinner.enable_steady_tick(Duration::from_millis(200));
    let (data, short) = budget::within(given.data(&arguments.data)?);
    let (heldout, short_heldout) = budget::within(given.heldout(&arguments.heldout)?);
    spinner.set_message("looking for causes");
    let options = Options {
        cutoff_hz: arguments.cutoff_hz,
        learn: arguments.learn,
        simulate: true,
        surrogates: if arguments.fast { 0 } else { SURROGATES },
        ..Options::default()
    };
    let mut outcome = diagnose(&given.model, &data, &heldout, &options)?;
    let next = match &arguments.next {
        Some(_) => next_motion::design(&given.model, &outcome)?,
        None => None,
    };
    spinner.finish_and_clear();
    outcome.diagnosis.next_experiment = next.as_ref().map(|n| n.summary.clone());
    let fast = arguments
        .fast
        .then(|| "no surrogates were drawn (--fast)".to_owned());
    for note in [short, short_heldout, fast].into_iter().flatten() {
        report::say!("Note: {note}.");
        outcome.diagnosis.notes.push(note);
    }
    for line in words::lines(&outcome.diagnosis) {
        report::say!("{line}");
    }
    let patch = if arguments.html.is_some() || arguments.patch.is_some() || arguments.out.is_some()
    {
        Some(patch::patch(&given.model, &outcome, &given.urdf)?)
    } else {
        None
    };
    let directory = arguments.out.as_ref().map(|_| {
        let cutoff_given = arguments.cutoff_hz.is_some();
        directory::directory(&given.model, &data, &heldout, &outcome, cutoff_given).map(|mut d| {
            // The recordings were joined: provenance names each.
            d.file.provenance.recordings = given.sources.clone();
            d
        })
    });
    let directory = directory.transpose()?;
    let urdf = patch.as_ref().map(|p| p.urdf.clone());
    let files = files(arguments, patch, &outcome);
    match (&arguments.next, &next) {
        (Some(path), Some(next)) => next.write(path)?,
        (Some(_), None) => {
            report::say!("No motion is needed: no two causes that one could tell apart.")
        }
        _ => {}
    }
    for (path, text) in &files {
        report::write_atomic(path, text)?;
    }
    if let (Some(path), Some(directory)) = (&arguments.out, &directory) {
        let weights = directory.compensator.as_deref();
        let (file, metrics) = (&directory.file, &directory.metrics);
        file.write(path, metrics, weights, urdf.as_deref())?;
        say_directory(path, directory);
    }
    if arguments.patch.is_some() {
        report::say!(
            "Patched model: {}",
            patch::summary(&outcome.diagnosis.causes)
        );
    }
    Ok(())
}

/// What the model directory holds and what it does not.
fn say_directory(path: &Path, directory: &Directory) {
    /// Departure from the ladder's step that is rounding, relative.
    const ROUNDING: f64 = 1e-6;
    let left_out = if directory.left_out.is_empty() {
        String::new()
    } else {
        let list = directory.left_out.join(", ");
        format!("; left out, as no torque model carries it: {list}")
    };
    report::say!("Model directory: {}{left_out}", path.display());
    if directory.departure > ROUNDING {
        report::say!(
            "  its torque differs from the ladder's last structural step by up to {:.2} % of a joint's torque",
            100.0 * directory.departure
        );
    }
}

/// Everything that is to be written, before anything is: a failure leaves no file behind.
fn files(
    arguments: &Arguments,
    patch: Option<patch::Patch>,
    outcome: &Outcome,
) -> Vec<(PathBuf, String)> {
    let mut files = Vec::new();
    if let Some(path) = &arguments.json {
        let text = serde_json::to_string_pretty(&outcome.diagnosis).expect("numbers and strings");
        files.push((path.clone(), text));
    }
    if let (Some(path), Some(patch)) = (&arguments.html, &patch) {
        let name = |p: &Path| p.display().to_string();
        let data: Vec<String> = arguments.data.iter().map(|p| name(p)).collect();
        let simulator = match (&arguments.robot, &arguments.model) {
            (Some(robot), _) => ("robot".to_owned(), robot.clone()),
            (None, model) => (
                "model".to_owned(),
                model.as_deref().map_or(String::new(), name),
            ),
        };
        let inputs = [
            simulator,
            ("data".to_owned(), data.join(", ")),
            ("held out".to_owned(), name(&arguments.heldout)),
        ];
        files.push((path.clone(), page::render(outcome, &inputs, patch)));
    }
    if let (Some(path), Some(patch)) = (&arguments.patch, patch) {
        files.push((path.clone(), patch.urdf));
        files.extend(
            patch
                .drive
                .map(|text| (path.with_extension("drive.toml"), text)),
        );
        files.push((path.with_extension("mjcf.xml"), patch.mjcf));
        files.push((path.with_extension("values.tsv"), patch.values));
    }
    files
}

fn run_proof(proof: &Proof) -> Result<(), prove::ProveError> {
    let Proof::Prove {
        cases,
        seed,
        only,
        leave_one_out,
        fast,
        out,
    } = proof;
    let options = Options {
        surrogates: if *fast { 0 } else { SURROGATES },
        ..Options::default()
    };
    let bar = ProgressBar::new(*cases);
    let (only, out) = (only.as_deref(), out.as_deref());
    let scores = prove::prove(*cases, *seed, only, &options, out, || bar.inc(1))?;
    bar.finish_and_clear();
    report::say!("{}", prove::table(&scores).to_text());
    if *leave_one_out {
        let bar = ProgressBar::new(*cases);
        let answers = prove::leave_one_out(*cases, *seed, || bar.inc(1))?;
        bar.finish_and_clear();
        report::say!("{}", prove::withheld_table(&answers).to_text());
    }
    Ok(())
}
