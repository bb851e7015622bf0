//! `diagnose`: where the gap between a simulator and a real robot lies, and what causes it.

use clap::{Args, Parser, Subcommand};
use datasets::Part;
use diagnose::diagnosis::{Outcome, diagnose};
use diagnose::error::DiagnoseError;
use diagnose::model::NominalModel;
use diagnose::objective::Settings;
use diagnose::{files, page, patch, prove, words};
use nalgebra::Vector3;
use physics::robot::Robot;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Diagnoses the gap between a simulator's torque and a real robot's: where it lies, which unmodelled
/// effect causes it, and how far it shrinks on held-out data.
#[derive(Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
struct Command {
    #[command(subcommand)]
    proof: Option<Proof>,
    #[command(flatten)]
    arguments: Option<Arguments>,
}

#[derive(Subcommand)]
enum Proof {
    /// Diagnoses sealed simulated cases with a withheld effect, and scores the answers.
    Prove {
        /// Number of cases.
        #[arg(long, default_value_t = 24)]
        cases: u64,
        /// Seed of the draw.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Folder for cases, answers and reports.
        #[arg(long)]
        out: Option<PathBuf>,
    },
}

#[derive(Args)]
struct Arguments {
    /// The simulator's model: a URDF, or the name of a built-in robot.
    #[arg(long)]
    robot: String,
    /// Recordings of the real robot on which effects are fitted.
    #[arg(long, required = true, num_args = 1..)]
    data: Vec<PathBuf>,
    /// Recording on which every figure is measured.
    #[arg(long)]
    heldout: PathBuf,
    /// Gravity in the base frame, m/s².
    #[arg(
        long,
        value_delimiter = ',',
        num_args = 3,
        allow_hyphen_values = true,
        value_name = "X,Y,Z"
    )]
    gravity: Option<Vec<f64>>,
    /// Write the report as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write the report as a self-contained page.
    #[arg(long)]
    html: Option<PathBuf>,
    /// Write the model with the accepted causes: a URDF, and beside it an MJCF snippet and a table of values.
    #[arg(long)]
    patch: Option<PathBuf>,
}

fn main() -> ExitCode {
    let command = Command::parse();
    match (command.proof, command.arguments) {
        (Some(Proof::Prove { cases, seed, out }), _) => {
            match run_proof(cases, seed, out.as_deref()) {
                Ok(()) => ExitCode::SUCCESS,
                Err(error) => {
                    eprintln!("diagnose: {error}");
                    ExitCode::FAILURE
                }
            }
        }
        (None, Some(arguments)) => match run(&arguments) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("diagnose: {error}");
                ExitCode::from(if error.is_input() { 2 } else { 1 })
            }
        },
        (None, None) => {
            eprintln!("diagnose: --robot, --data and --heldout are needed; see --help");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), DiagnoseError> {
    let mut robot = Robot::load(&arguments.robot)?;
    if let Some(g) = &arguments.gravity {
        robot = robot.with_gravity(Vector3::new(g[0], g[1], g[2]));
    }
    let data = files::data(&robot, &arguments.data)?;
    let heldout = files::recording(&robot, &arguments.heldout, Part::Test)?;
    let model = NominalModel { robot };
    let outcome = diagnose(&model, &data, &heldout, Settings::default())?;
    for line in words::lines(&outcome.diagnosis) {
        println!("{line}");
    }
    write_files(arguments, &model, &outcome)
}

fn write_files(
    arguments: &Arguments,
    model: &NominalModel,
    outcome: &Outcome,
) -> Result<(), DiagnoseError> {
    if let Some(path) = &arguments.json {
        write(
            path,
            &serde_json::to_string_pretty(&outcome.diagnosis).expect("numbers and strings"),
        )?;
    }
    if let Some(path) = &arguments.html {
        let name = |p: &Path| p.display().to_string();
        let data = arguments
            .data
            .iter()
            .map(|p| name(p))
            .collect::<Vec<_>>()
            .join(", ");
        let inputs = [
            ("robot".to_owned(), arguments.robot.clone()),
            ("data".to_owned(), data),
            ("held out".to_owned(), name(&arguments.heldout)),
        ];
        write(path, &page::render(outcome, &inputs))?;
    }
    if let Some(path) = &arguments.patch {
        let text = std::fs::read_to_string(&arguments.robot).ok();
        let patch = patch::patch(model, outcome, text.as_deref())?;
        write(path, &patch.urdf)?;
        write(&path.with_extension("mjcf.xml"), &patch.mjcf)?;
        write(&path.with_extension("values.tsv"), &patch.values)?;
        println!(
            "Patched model: {}",
            patch::summary(&outcome.diagnosis.causes)
        );
    }
    Ok(())
}

fn write(path: &Path, text: &str) -> Result<(), DiagnoseError> {
    Ok(report::write_atomic(path, text)?)
}

fn run_proof(cases: u64, seed: u64, out: Option<&Path>) -> Result<(), prove::ProveError> {
    let bar = indicatif::ProgressBar::new(cases);
    let scores = prove::prove(cases, seed, out, || bar.inc(1))?;
    bar.finish_and_clear();
    println!("{}", prove::table(&scores).to_text());
    Ok(())
}
