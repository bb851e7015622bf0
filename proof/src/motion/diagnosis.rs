//! A diagnosis by the program `replay`: its arguments, and its run from files to files.
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

use clap::Args;
use program::Running;
use replay::{Job, Options, ReplayError};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

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
    /// Earlier recordings of the same robot: what has changed since is looked for, and the simulator is fitted to them first.
    #[arg(long, num_args = 1..)]
    before: Vec<PathBuf>,
    /// Drive file with the block [controller], and names and units of columns. Without that block the MJCF's own
    /// actuators are used.
    #[arg(long)]
    drive: Option<PathBuf>,
    /// Gravity in the base frame, m/s².
    #[arg(long, value_parser = model::preparation::setup::gravity, allow_hyphen_values = true)]
    gravity: Option<[f64; 3]>,
    /// Write the report as JSON; `-` is standard output.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write the report as a self-contained HTML page.
    #[arg(long)]
    html: Option<PathBuf>,
    /// Write the corrected model: an MJCF with actuators, damping, friction loss, armature and inertials; or a URDF
    /// with a drive file beside it.
    #[arg(long)]
    patch: Option<PathBuf>,
    /// Measure the causes' shares by shorter fits, each without one cause: faster. A share is too large where other values would take
    /// that cause's place.
    #[arg(long)]
    fast: bool,
    /// Fit the same effects to the held-out recording itself, too: no values of them leave much less there.
    #[arg(long)]
    ceiling: bool,
}

/// Makes the diagnosis that the arguments ask for, prints it and writes its files. Returns the exit status: 2 for input
/// that cannot be used, 1 for a file that cannot be written.
pub fn run(arguments: &Arguments, running: &Running) -> ExitCode {
    running.run(|| match diagnosed(arguments, running) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            report::warn!("error: {error}");
            ExitCode::from(if error.is_input() { 2 } else { 1 })
        }
    })
}

/// Diagnosis, printed and written to the files that were asked for.
fn diagnosed(arguments: &Arguments, running: &Running) -> Result<(), ReplayError> {
    let outputs = [&arguments.json, &arguments.html, &arguments.patch];
    report::write::prepare(outputs.into_iter().flatten())?;
    let job = Job {
        robot: arguments.robot.clone(),
        joints: arguments.joints.clone(),
        data: arguments.data.clone(),
        heldout: arguments.heldout.clone(),
        before: arguments.before.clone(),
        drive: arguments.drive.clone(),
        gravity: arguments.gravity,
        options: Options::default()
            .fast(arguments.fast)
            .ceiling(arguments.ceiling),
    };
    let begun = Instant::now();
    let spinner = running.spinner();
    let done = job.run(|stage| {
        report::say::stage(begun, stage);
        spinner.set_message(stage.to_owned());
    })?;
    spinner.finish_and_clear();
    for line in done.lines() {
        report::say!("{line}");
    }
    let mut files = Vec::new();
    if let Some(path) = &arguments.json {
        files.push((path.clone(), done.json()));
    }
    let (mut left_out, mut changes) = (Vec::new(), Vec::new());
    let mut patched = Vec::new();
    if let Some(path) = &arguments.patch {
        let patch = done.patch(path)?;
        (left_out, changes) = (patch.left_out, patch.changes);
        patched = patch.files;
    }
    if let Some(path) = &arguments.html {
        let named: Vec<PathBuf> = patched.iter().map(|(path, _)| path.clone()).collect();
        files.push((path.clone(), done.page(&named)));
    }
    files.extend(patched);
    for (path, text) in &files {
        report::write_atomic(path, text)?;
    }
    if let Some(path) = &arguments.patch {
        let part = done.outcome.report.file_alone.figures.mean_unexplained;
        match part {
            _ if done.nothing_to_correct() => {
                report::say!(
                    "Nothing to correct: {} is the model as given.",
                    path.display()
                );
            }
            Some(part) => report::say!(
                "The corrected model file, fitted for what it can hold, leaves {:.0} % unexplained. It changes:",
                100.0 * part
            ),
            None => report::say!("The corrected model file changes:"),
        }
        for line in changes {
            report::say!("  {line}");
        }
    }
    for line in left_out {
        report::say!("Not in the corrected model: {line}.");
    }
    report::write::say_written(files.iter().map(|(path, _)| path));
    Ok(())
}
