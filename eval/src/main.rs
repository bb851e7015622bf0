//! `eval`: scores and predictions of a model directory on a recording.
#![forbid(unsafe_code)]
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod leaderboard;
mod sources;

use clap::Parser;
use datasets::{Part, read};
use model::baseline::published::{self, Published, beside};
use model::directory::{ModelFile, json};
use model::evaluation::{EvaluateOptions, Evaluation, evaluate, read_options};
use model::failure::Failure;
use model::leaderboard::Contest;
use model::{page, residual, tables};
use report::{say, say_text};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Scores a model directory on a recording and predicts its torque.
#[derive(Debug, Parser)]
#[command(name = "eval", version)]
struct Arguments {
    /// Print the systems of the source documents, which of them work, and published figures beside ours (Markdown); needs neither
    /// model nor data.
    #[arg(long, exclusive = true)]
    sources: bool,
    /// Model directory.
    #[arg(long, required_unless_present_any = ["sources", "leaderboard"])]
    model: Option<PathBuf>,
    /// Compare models of one robot on the recording, beside published results; --html, --markdown and --json then write that page.
    #[arg(long, value_name = "DIR", num_args = 1.., conflicts_with_all = ["model", "onnx", "predict", "verbose"])]
    leaderboard: Vec<PathBuf>,
    /// Recording (.csv, .parquet, .npz, or the KR300 benchmark's .mat: its test part).
    #[arg(long, required_unless_present_any = ["sources", "onnx"])]
    data: Option<PathBuf>,
    /// Write the scores as JSON.
    #[arg(long, requires = "data")]
    json: Option<PathBuf>,
    /// Write a report page.
    #[arg(long, requires = "data")]
    html: Option<PathBuf>,
    /// With --leaderboard: write the page as Markdown.
    #[arg(long, requires = "leaderboard", conflicts_with = "model")]
    markdown: Option<PathBuf>,
    /// Write predicted torque and its standard deviation as CSV; the recording needs no torque.
    #[arg(long, requires = "data")]
    predict: Option<PathBuf>,
    /// Write the compensator of all joints as one ONNX graph, with its inputs in a JSON file beside it (NAME.json).
    #[arg(long, value_name = "NAME")]
    onnx: Option<PathBuf>,
    /// Drive file: names and units of the recording's columns, gear ratios, torque constants.
    #[arg(long)]
    drive: Option<PathBuf>,
    /// Cut-off of the zero-phase low-pass of the motion, Hz [default: the model's own].
    #[arg(long)]
    cutoff_hz: Option<f64>,
    /// Print the scores of every model and scope.
    #[arg(long, conflicts_with = "quiet")]
    verbose: bool,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(e) => {
            let _ = e.print();
            return ExitCode::from(if e.use_stderr() { 2 } else { 0 });
        }
    };
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
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
        return leaderboard::run(&contest, &places, arguments.quiet);
    }
    let Some(model) = &arguments.model else {
        let table = sources::markdown().map_err(|e| Failure::other(e.to_string()))?;
        say_text!(table);
        return Ok(());
    };
    let file = ModelFile::load(model)?;
    if let Some(path) = &arguments.onnx {
        export(model, &file, path, arguments.quiet)?;
    }
    let Some(data) = &arguments.data else {
        return Ok(());
    };
    let torque_needed = arguments.predict.is_none();
    let options = read_options(&file, arguments.drive.as_deref(), Part::Test, torque_needed)?;
    let recording = read(data, &options).map_err(|e| Failure::input(e.to_string(), ""))?;
    let options = EvaluateOptions {
        cutoff_hz: arguments.cutoff_hz,
    };
    let evaluation = evaluate(model, &file, recording, &options)?;
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
    }
    Ok(())
}

/// Writes the compensator's graph and, beside it, the description of its inputs.
fn export(model: &Path, file: &ModelFile, path: &Path, quiet: bool) -> Result<(), Failure> {
    let stored = residual::load(model, file)?;
    let (Some(compensator), Some(record)) = (&stored, &file.compensator) else {
        return Err(Failure::input(
            format!("{} holds no compensator", model.display()),
            "Train without --physics-only.",
        ));
    };
    let exported = residual::onnx::export(compensator, record, file)?;
    let mut beside = path.as_os_str().to_owned();
    beside.push(".json");
    let beside = Path::new(&beside);
    report::write_atomic(beside, json(&exported.description))?;
    report::write_atomic(path, &exported.graph)?;
    if !quiet {
        let (graph, inputs) = (path.display(), beside.display());
        let joints = file.joints.len();
        say!("{graph}: compensator of {joints} joints; inputs: {inputs}");
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

/// Width of a line for a person.
const WIDTH: usize = 100;

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
