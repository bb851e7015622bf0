//! Command line of `replay`.
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

use crate::catalogue::Effect;
use crate::diagnosis::diagnose;
use crate::input::{InputError, Subject};
use crate::simulate::Unstable;
use crate::tracks::Replayed;
use crate::{page, patch, words};
use clap::Args;
use datasets::Part;
use indicatif::ProgressBar;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// Arguments of a diagnosis.
#[derive(Args)]
pub struct Arguments {
    /// URDF or MJCF, or the name of a built-in robot: the simulator's model as it is.
    #[arg(long)]
    robot: String,
    /// Joints of the robot, base first, where the description holds more than the recording.
    #[arg(long, value_delimiter = ',')]
    joints: Vec<String>,
    /// Recordings to fit: time, q1 …, q_ref1 …
    #[arg(long, num_args = 1.., required = true)]
    data: Vec<PathBuf>,
    /// Recording on which every figure is measured.
    #[arg(long)]
    heldout: PathBuf,
    /// Drive file with the block [controller], and names and units of columns. An MJCF's own actuators stand where it says
    /// nothing.
    #[arg(long)]
    drive: Option<PathBuf>,
    /// Gravity in the base frame, m/s².
    #[arg(long, value_parser = model::preparation::setup::gravity, allow_hyphen_values = true)]
    gravity: Option<[f64; 3]>,
    /// Report as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Report as a page.
    #[arg(long)]
    html: Option<PathBuf>,
    /// Corrected model: an MJCF with actuators, damping, friction loss, armature and inertials; or a URDF with a drive file
    /// beside it.
    #[arg(long)]
    patch: Option<PathBuf>,
    /// Shorten the fits without one cause each, by which shares are measured.
    #[arg(long)]
    fast: bool,
}

#[derive(Debug, thiserror::Error)]
enum ReplayError {
    #[error(transparent)]
    Input(#[from] InputError),
    #[error(transparent)]
    Unstable(#[from] Unstable),
    #[error(transparent)]
    Patch(#[from] patch::PatchError),
    #[error(transparent)]
    Write(#[from] report::WriteError),
    #[error("{}: its folder does not exist; make it first", .0.display())]
    Folder(PathBuf),
    #[error("--heldout {} is among --data: what is measured on it says nothing; give a recording of its own", .0.display())]
    NotHeldOut(PathBuf),
}

impl ReplayError {
    fn is_input(&self) -> bool {
        !matches!(self, Self::Write(_))
    }
}

/// Makes the diagnosis that the arguments ask for; the program's exit status.
pub fn run(arguments: &Arguments) -> ExitCode {
    match diagnosed(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            report::warn!("error: {error}");
            ExitCode::from(if error.is_input() { 2 } else { 1 })
        }
    }
}

fn diagnosed(arguments: &Arguments) -> Result<(), ReplayError> {
    check_outputs(arguments)?;
    let canonical = |p: &Path| p.canonicalize().unwrap_or_else(|_| p.to_owned());
    if arguments
        .data
        .iter()
        .any(|d| canonical(d) == canonical(&arguments.heldout))
    {
        return Err(ReplayError::NotHeldOut(arguments.heldout.clone()));
    }
    let subject = Subject::read(
        &arguments.robot,
        &arguments.joints,
        arguments.drive.as_deref(),
        arguments.gravity,
    )?;
    let data = joined(subject.recordings(&arguments.data, Part::Train)?);
    let heldout = joined(subject.recordings(std::slice::from_ref(&arguments.heldout), Part::Test)?);
    let spinner = ProgressBar::new_spinner();
    spinner.enable_steady_tick(Duration::from_millis(200));
    let outcome = diagnose(&subject.given, &data, &heldout, arguments.fast, |stage| {
        spinner.set_message(stage.to_owned());
    })?;
    spinner.finish_and_clear();
    let title = |name: &str| {
        Effect::ALL
            .iter()
            .find(|e| e.name() == name)
            .map_or("", |e| e.words())
    };
    for line in words::lines(&outcome.report, title) {
        report::say!("{line}");
    }
    let mut files = Vec::new();
    if let Some(path) = &arguments.json {
        let text = serde_json::to_string_pretty(&outcome.report).expect("a report is plain data");
        files.push((path.clone(), text + "\n"));
    }
    if let Some(path) = &arguments.html {
        let name = subject.setup.robot.name();
        files.push((
            path.clone(),
            page::page(&outcome, &heldout, &format!("Replay of {name}")),
        ));
    }
    let mut left_out = Vec::new();
    if let Some(path) = &arguments.patch {
        let patch = patch::patch(&subject.setup, &subject.given, &outcome.held, path)?;
        left_out = patch.left_out;
        files.extend(patch.files);
    }
    for (path, text) in &files {
        report::write_atomic(path, text)?;
    }
    if let (Some(_), Some(part)) = (
        &arguments.patch,
        outcome.report.file_alone.figures.mean_unexplained,
    ) {
        report::say!(
            "The corrected model file by itself leaves {:.0} % unexplained.",
            100.0 * part
        );
    }
    for line in left_out {
        report::say!("Not in the corrected model: {line}.");
    }
    for (path, _) in &files {
        report::say!("Written: {}", path.display());
    }
    Ok(())
}

/// Refuses outputs whose folder does not exist, before work begins.
fn check_outputs(arguments: &Arguments) -> Result<(), ReplayError> {
    let outputs = [&arguments.json, &arguments.html, &arguments.patch];
    for path in outputs.into_iter().flatten() {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
        if folder.is_some_and(|p| !p.is_dir()) {
            return Err(ReplayError::Folder(path.clone()));
        }
    }
    Ok(())
}

/// Several recordings as one.
fn joined(all: Vec<Replayed>) -> Replayed {
    let mut all = all.into_iter();
    let mut out = all.next().expect("at least one recording is asked for");
    for next in all {
        out.join(next);
    }
    out
}
