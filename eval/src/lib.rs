//! `eval`: scores and predictions of a model directory on a recording.
#![forbid(unsafe_code)]
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod arguments;
#[cfg(feature = "reproductions")]
mod closed_loop;
#[cfg(feature = "reproductions")]
mod collision;
mod leaderboard;
mod sources;

use arguments::{Arguments, WIDTH};
use clap::CommandFactory;
use datasets::{Part, read};
use feedforward::network::Weights;
use leaderboard::Printed;
use model::baseline::published::{self, Published, beside};
use model::directory::{ModelFile, json};
use model::evaluation::{EvaluateOptions, Evaluation, GROWTH, evaluate, form, read_options};
use model::failure::Failure;
use model::leaderboard::Contest;
use model::{page, residual, tables};
use report::{say, say_text};
use sources::SourcesError;
use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

/// The command line, as clap takes it.
pub fn command() -> clap::Command {
    program::with_config(Arguments::command())
}

/// Runs the program `eval` with these arguments, of which the first is its name; returns the exit status.
/// `--help` and wrong usage end the process here, as clap does.
pub fn command_line(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments: Arguments = program::parse(arguments);
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let outputs = [
        &arguments.json,
        &arguments.html,
        &arguments.markdown,
        &arguments.predict,
    ];
    report::write::prepare(outputs.into_iter().flatten())?;
    #[cfg(not(feature = "reproductions"))]
    if arguments.closed_loop || arguments.collision {
        return Err(Failure::input(
            "this program was built without --closed-loop and --collision",
            "Build it with them: cargo build --release --features residyn-eval/reproductions.",
        ));
    }
    #[cfg(feature = "reproductions")]
    if arguments.closed_loop {
        return closed_loop::run(arguments);
    }
    if let (false, Some(data)) = (arguments.leaderboard.is_empty(), &arguments.data) {
        let contest = Contest {
            directories: &arguments.leaderboard,
            data,
            drive: arguments.drive.as_deref(),
            cutoff_hz: arguments.cutoff_hz,
        };
        let places = leaderboard::Places {
            html: arguments.html.as_ref(),
            markdown: arguments.markdown.as_ref(),
            json: arguments.json.as_ref(),
        };
        let printed = match () {
            () if arguments.table => Printed::Table,
            () if arguments.quiet => Printed::Nothing,
            () => Printed::Rows,
        };
        return leaderboard::run(&contest, &places, printed);
    }
    let Some(model) = &arguments.model else {
        let page = match arguments.sources.as_deref() {
            None | Some("") => sources::markdown(),
            Some(document) => sources::page(document),
        };
        say_text!(page.map_err(|e| match e {
            SourcesError::Page { .. } => Failure::input(e.to_string(), ""),
            SourcesError::Rows(_) => Failure::other(e.to_string()),
        })?);
        return Ok(());
    };
    let file = ModelFile::load(model)?;
    if let Some(path) = &arguments.onnx {
        export(model, &file, path, arguments)?;
    }
    let Some(data) = &arguments.data else {
        return Ok(());
    };
    let torque_needed = arguments.predict.is_none();
    let mut options = read_options(&file, arguments.drive.as_deref(), Part::Test, torque_needed)?;
    options.rate_hz = arguments.rate;
    let recording = read(data, &options).map_err(|e| Failure::input(e.to_string(), ""))?;
    let options = EvaluateOptions {
        cutoff_hz: arguments.cutoff_hz,
    };
    let evaluation = evaluate(model, &file, recording, &options)?;
    #[cfg(feature = "reproductions")]
    if arguments.collision {
        return collision::run(arguments, model, &file, &evaluation);
    }
    if let (Some(form), Some(out)) = (arguments.weights, &arguments.out) {
        choose_weights(arguments, &file, &evaluation, form.into(), out)?;
    }
    // Pages first: nothing is printed of a run whose files cannot be written.
    if let Some(path) = &arguments.json {
        report::write_atomic(path, json(&evaluation.report))?;
    }
    if let Some(path) = &arguments.html {
        let published = published(&file);
        let subject = evaluation.subject(&published);
        report::write_atomic(path, page::page(&file, &subject).render())?;
    }
    if let Some(path) = &arguments.predict {
        evaluation.write_prediction(path)?;
    }
    if !arguments.quiet {
        print(&file, &evaluation, arguments.verbose);
        let outputs = [&arguments.json, &arguments.html, &arguments.predict];
        report::write::say_written(outputs.into_iter().flatten());
    }
    Ok(())
}

/// Writes the compensator's graph and, beside it, the description of its inputs.
fn export(
    model: &Path,
    file: &ModelFile,
    path: &Path,
    arguments: &Arguments,
) -> Result<(), Failure> {
    let stored = residual::load(model, file)?;
    let (Some(compensator), Some(record)) = (&stored, &file.compensator) else {
        return Err(Failure::input(
            format!("{} holds no compensator", model.display()),
            "Train without --physics-only.",
        ));
    };
    let exported = if arguments.stepwise {
        residual::onnx::export_stepwise(compensator, record, file)?
    } else if residual::onnx::carries_state(compensator) {
        return Err(Failure::input(
            "the compensator carries its state from sample to sample, which no graph over one window holds",
            "Add --stepwise.",
        ));
    } else {
        residual::onnx::export(compensator, record, file)?
    };
    let mut beside = path.as_os_str().to_owned();
    beside.push(".json");
    let beside = Path::new(&beside);
    report::write_atomic(beside, &exported.description)?;
    report::write_atomic(path, &exported.graph)?;
    if !arguments.quiet {
        let (graph, inputs) = (path.display(), beside.display());
        let joints = file.joints.len();
        say!("{graph}: compensator of {joints} joints; inputs: {inputs}");
    }
    Ok(())
}

/// Writes the model with weights in another form, where that costs little on the recording.
fn choose_weights(
    arguments: &Arguments,
    file: &ModelFile,
    evaluation: &Evaluation,
    weights: Weights,
    out: &Path,
) -> Result<(), Failure> {
    let none = || {
        Failure::input(
            "weights are chosen for a model with a compensator, on a recording with torque",
            "Train without --physics-only; give --data a recording with tau columns.",
        )
    };
    let Some(model) = &arguments.model else {
        return Err(none());
    };
    let formed = form(model, file, evaluation, weights)?.ok_or_else(none)?;
    let grown = |joint: usize| {
        let [whole, narrow] = formed.errors[joint];
        let percent = 100.0 * (narrow / whole - 1.0);
        format!("{} {percent:+.2} %", file.joints[joint])
    };
    let worse = formed.worse();
    if !worse.is_empty() {
        let joints: Vec<String> = worse.into_iter().map(grown).collect();
        return Err(Failure::input(
            format!(
                "the torque's error grows by more than {} %: {}",
                100.0 * GROWTH,
                joints.join(", ")
            ),
            "Nothing was written. Take a wider form: bf16, or f32.",
        ));
    }
    formed.write(out)?;
    if !arguments.quiet {
        let joints: Vec<String> = (0..formed.errors.len()).map(grown).collect();
        let line = format!(
            "{}: growth of the torque's error by joint: {}",
            out.display(),
            joints.join(", ")
        );
        say_text!(report::wrapped(&line, WIDTH, ""));
    }
    Ok(())
}

/// Results to stand beside the scores.
fn published(file: &ModelFile) -> Vec<&'static Published> {
    beside(
        file.physics.builtin,
        &[published::Part::Test, published::Part::Train],
    )
}

fn print(file: &ModelFile, evaluation: &Evaluation, verbose: bool) {
    let report = &evaluation.report;
    say!(
        "{}: {} samples, robot {}",
        evaluation.recording.source,
        report.samples,
        file.physics.robot
    );
    if verbose && !report.rows.is_empty() {
        tables_of(file, evaluation);
    } else if let Some(table) = tables::errors_by_joint(&file.joints, &report.rows) {
        say!("\nNRMSE (error over the torque's deviation):\n");
        say_text!(table.to_text());
        say!();
    }
    for line in report.worth() {
        say_text!(report::wrapped(&line, WIDTH, ""));
    }
    let published = published(file);
    if !report.rows.is_empty() && !published.is_empty() {
        say!("Published, mean NRMSE:");
        for p in published {
            let (model, part) = (p.model, p.part.name());
            let line = format!("{:.4} {model}, {part}: {}", p.mean_nrmse, p.source);
            say_text!(report::wrapped(&line, WIDTH, "  "));
        }
        say!();
    }
    for note in &report.notes {
        say_text!(report::wrapped(note, WIDTH, ""));
    }
}

/// Every score of every model and scope.
fn tables_of(file: &ModelFile, evaluation: &Evaluation) {
    let (joints, rows, published) = (&file.joints, &evaluation.report.rows, published(file));
    say!("\nNRMSE");
    say_text!(tables::scores(joints, rows, &published).to_text());
    say!("\nRMSE");
    say_text!(tables::errors(joints, rows).to_text());
    if let Some(table) = tables::forward(joints, rows, &published) {
        say!("\nNRMSE of positions simulated from torque");
        say_text!(table.to_text());
    }
}
