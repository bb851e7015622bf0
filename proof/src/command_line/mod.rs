//! Command line of `diagnose`.
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod arguments;

use crate::prove::thresholds::Trial;
use crate::{attainable, prove};
use arguments::{Arguments, Command, Proof, Sealed};
use clap::CommandFactory;
use datasets::write::{curves_ending, write_curves};
use diagnose::directory::Directory;
use diagnose::settings::Rule;
use diagnose::{DiagnoseError, Done, Job, Options, SURROGATES, Subject, layouts, patch, words};
use indicatif::ProgressBar;
use physics::robot::Description;
use program::Running;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// The command line, as clap takes it.
pub fn command() -> clap::Command {
    program::with_config(Command::command())
}

/// Runs the program `diagnose` and returns its exit status. The first of the arguments is the name by which it was
/// called. `--help` and wrong usage end the process here, as clap does it.
pub fn command_line(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let command: Command = program::parse(arguments);
    match (command.proof, command.arguments) {
        (Some(proof), _) => match run_proof(proof) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                report::warn!("error: {error}");
                ExitCode::from(if error.is_input() { 2 } else { 1 })
            }
        },
        (None, Some(arguments)) => {
            command
                .running
                .run(|| match run(&arguments, &command.running) {
                    Ok(()) => ExitCode::SUCCESS,
                    Err(error) => {
                        report::warn!("error: {error}");
                        if let Some(hint) = error.hint() {
                            report::warn!("hint: {hint}");
                        }
                        ExitCode::from(if error.is_input() { 2 } else { 1 })
                    }
                })
        }
        (None, None) => {
            report::warn!("error: --robot or --model, --data and --heldout are needed; see --help");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments, running: &Running) -> Result<(), DiagnoseError> {
    let outputs = [
        &arguments.json,
        &arguments.html,
        &arguments.patch,
        &arguments.next,
        &arguments.trace,
    ];
    let beside: Vec<PathBuf> = arguments
        .trace
        .iter()
        .flat_map(|p| layouts::paths(p))
        .collect();
    report::write::prepare(outputs.into_iter().flatten().chain(&beside))?;
    if let Some(path) = &arguments.trace {
        curves_ending(path)?;
    }
    let begun = Instant::now();
    let spinner = running.spinner();
    let done = job(arguments).run(|stage| {
        report::say::stage(begun, stage);
        spinner.set_message(stage);
    })?;
    spinner.finish_and_clear();
    for warning in &done.warnings {
        report::say!("Warning: {warning}.");
    }
    for note in &done.notes {
        report::say!("Note: {note}.");
    }
    for line in words::lines(&done.outcome.diagnosis) {
        report::say!("{line}");
    }
    let patched = arguments.html.is_some() || arguments.patch.is_some() || arguments.out.is_some();
    let patch = patched.then(|| done.patch()).transpose()?;
    let directory = arguments.out.as_ref().map(|_| done.directory());
    let directory = directory.transpose()?;
    let urdf = patch.as_ref().map(|p| p.urdf.clone());
    let left_out = patch.as_ref().map_or(Vec::new(), |p| p.left_out());
    let files = files(arguments, patch.as_ref(), &done)?;
    match (&arguments.next, &done.next) {
        (Some(path), Some(next)) => next.write(path)?,
        (Some(_), None) => {
            report::say!("No motion is needed: no two causes that one could tell apart.")
        }
        _ => {}
    }
    for (path, text) in &files {
        report::write_atomic(path, text)?;
    }
    if let Some(path) = &arguments.trace {
        write_curves(&done.trace(), path)?;
    }
    if let (Some(path), Some(directory)) = (&arguments.out, &directory) {
        let weights = directory.compensator.as_deref();
        let (file, metrics) = (&directory.file, &directory.metrics);
        file.write(path, metrics, weights, urdf.as_deref())?;
        say_directory(path, directory);
    }
    if let (Some(path), Some(patch)) = (&arguments.patch, &patch) {
        for stale in patch.remove_stale(path) {
            report::say!("Removed, as an earlier patch's: {}", stale.display());
        }
    }
    if arguments.patch.is_some() {
        let mjcf = matches!(done.given.description, Description::Mjcf(_));
        let changes = patch.as_ref().map_or(&[][..], |p| &p.changes);
        report::say!(
            "Patched model: {}",
            patch::summary(&done.outcome.diagnosis.causes, mjcf, !changes.is_empty())
        );
        for line in changes {
            report::say!("  {line}");
        }
        for line in left_out {
            report::say!("  left out: {line}");
        }
    }
    report::write::say_written(files.iter().map(|(path, _)| path).chain(&arguments.trace));
    Ok(())
}

/// Diagnosis that the arguments ask for.
fn job(arguments: &Arguments) -> Job {
    let subject = match (&arguments.robot, &arguments.model) {
        (Some(robot), _) => Subject::Robot {
            source: robot.clone(),
            joints: arguments.joints.clone(),
            gravity: arguments.gravity,
        },
        (None, Some(directory)) => Subject::Model(directory.clone()),
        (None, None) => unreachable!("the command line demands one of them"),
    };
    Job {
        subject: subject.as_in(arguments.before.clone()),
        drive: arguments.drive.clone(),
        rate_hz: arguments.rate,
        data: arguments.data.clone(),
        heldout: arguments.heldout.clone(),
        cutoff_hz: arguments.cutoff_hz,
        fast: arguments.fast,
        learn: arguments.learn,
        next: arguments.next.is_some(),
    }
}

/// Prints what a written model directory holds, and the causes that it cannot hold.
fn say_directory(path: &Path, directory: &Directory) {
    /// Relative departure from the ladder's step up to which it counts as rounding.
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
    patch: Option<&patch::Patch>,
    done: &Done,
) -> Result<Vec<(PathBuf, String)>, DiagnoseError> {
    let mut files = Vec::new();
    if let Some(path) = &arguments.json {
        files.push((path.clone(), done.json()));
    }
    let patched = match (&arguments.patch, patch) {
        (Some(path), Some(patch)) => patch.files(path)?,
        _ => Vec::new(),
    };
    if let (Some(path), Some(patch)) = (&arguments.html, patch) {
        let named: Vec<PathBuf> = patched.iter().map(|(path, _)| path.clone()).collect();
        files.push((path.clone(), done.page(patch, &named)));
    }
    files.extend(patched);
    if let Some(path) = &arguments.trace {
        files.extend(done.layouts(path));
    }
    Ok(files)
}

fn run_proof(proof: Proof) -> Result<(), prove::ProveError> {
    match proof {
        Proof::Prove(sealed) => prove_sealed(&sealed),
        Proof::Score { folder, fast } => {
            let names = prove::given::names(&folder)?;
            let bar = ProgressBar::new(names.len() as u64);
            let scores = prove::given::given(&folder, &names, fast, || bar.inc(1))?;
            bar.finish_and_clear();
            say_scores(&scores);
            Ok(())
        }
        Proof::Thresholds {
            cases,
            seed,
            generator,
            joints,
            headline,
            off,
            together,
            out,
        } => {
            let all = off.iter().any(|name| name == "all");
            let rules = Rule::ALL.into_iter();
            let rules = rules.filter(|r| all || off.iter().any(|name| name == r.name()));
            let trial = match (off.is_empty(), together) {
                (true, _) => Trial::Numbers,
                (_, false) => Trial::Off(rules.collect()),
                (_, true) => Trial::OffTogether(rules.collect()),
            };
            let first = prove::thresholds::Cases {
                count: cases,
                seed,
                generator,
                joints,
            };
            let stored = headline.as_deref().map(prove::Stored::read).transpose()?;
            let count = stored.as_ref().map_or(cases, |s| s.cases.len() as u64);
            let bar = ProgressBar::new(prove::thresholds::diagnoses(count, &trial));
            let (out, done) = (out.as_deref(), || bar.inc(1));
            let tried = match &stored {
                Some(stored) => prove::thresholds::run(stored.made(), &trial, out, done)?,
                None => prove::thresholds::run(first.made(), &trial, out, done)?,
            };
            bar.finish_and_clear();
            report::say!("{}", prove::thresholds::table(&tried).to_text());
            Ok(())
        }
        Proof::Changes { cases, seed } => {
            let bar = ProgressBar::new(cases);
            let told = prove::changed::run(cases, seed, || bar.inc(1))?;
            bar.finish_and_clear();
            report::say!("{}", prove::changed::table(&told).to_text());
            Ok(())
        }
    }
}

/// Scores by kind of case, and rates.
fn say_scores(scores: &[prove::Score]) {
    let stored = scores.iter().filter(|s| s.stored).count();
    if stored > 0 {
        report::say!("{stored} of the reports were there already.");
    }
    report::say!("{}", prove::table(scores).to_text());
    report::say!("{}", prove::rates_table(scores).to_text());
    let tables = [
        prove::missed_table(scores),
        prove::false_table(scores),
        prove::drawn_table(scores),
    ];
    for table in tables.into_iter().flatten() {
        report::say!("{}", table.to_text());
    }
}

fn prove_sealed(proof: &Sealed) -> Result<(), prove::ProveError> {
    let Sealed {
        cases,
        seed,
        hard,
        only,
        without,
        generator,
        leave_one_out,
        attainable: with_observer,
        calibrate,
        with,
        fast,
        out,
        link_encoders,
        temperatures,
    } = proof;
    let options = Options {
        surrogates: if *fast { 0 } else { SURROGATES },
        ..Options::default()
    };
    let bar = ProgressBar::new(*cases);
    let (only, out) = (only.as_deref(), out.as_deref());
    let draw = prove::Draw {
        cases: *cases,
        seed: *seed,
        hard: *hard,
        only,
        without: without.as_deref().and_then(trials::cases::effect_index),
        generator: *generator,
        sensors: trials::cases::Sensors {
            links: *link_encoders,
            temperatures: *temperatures,
        },
    };
    let scores = prove::prove(&draw, &options, out, || bar.inc(1))?;
    bar.finish_and_clear();
    say_scores(&scores);
    if *with_observer {
        let bar = ProgressBar::new(*cases);
        let known = attainable::attainable(&draw, out, || bar.inc(1))?;
        bar.finish_and_clear();
        report::say!("What can be known of these cases, beside the diagnosis:");
        let pairs: Vec<_> = scores.iter().zip(&known).collect();
        report::say!("{}", attainable::rates(&pairs).to_text());
        let bar = ProgressBar::new(*cases);
        let lost = attainable::lost::lost(&draw, &options, &pairs, || bar.inc(1))?;
        bar.finish_and_clear();
        let tables = [
            attainable::by_kind(&pairs),
            attainable::by_drawn(&pairs),
            attainable::lost::table(&lost),
        ];
        for table in tables.into_iter().flatten() {
            report::say!("{}", table.to_text());
        }
    }
    let said = prove::said(&scores, &options.settings.measure.confidence);
    if !said.is_empty() {
        report::say!("{}", prove::reliability_table(&said).to_text());
    }
    if *calibrate {
        let mut all = scores;
        for folder in with {
            all.extend(prove::kept(folder)?);
        }
        report::say!("{}", prove::weights_table(&all).to_text());
        report::say!("Each case's causes by the weights that the other cases give:");
        let left_out = prove::left_out(&all);
        report::say!("{}", prove::reliability_table(&left_out).to_text());
    }
    if *leave_one_out {
        let bar = ProgressBar::new(*cases);
        let answers = prove::leave_one_out(*cases, *seed, *generator, || bar.inc(1))?;
        bar.finish_and_clear();
        report::say!("{}", prove::withheld_table(&answers).to_text());
    }
    Ok(())
}
