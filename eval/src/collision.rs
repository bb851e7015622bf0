//! `eval --collision`: thresholds of a collision detector on the model's residual, and its alarms.

use crate::arguments::{Arguments, WIDTH};
use control::collision::{of_recording, page, tables};
use datasets::{Part, read};
use model::directory::{ModelFile, json};
use model::evaluation::{EvaluateOptions, Evaluation, evaluate, read_options};
use model::failure::Failure;
use report::{say, say_text};
use std::path::Path;

/// Thresholds and alarms: writes, prints.
pub fn run(
    arguments: &Arguments,
    directory: &Path,
    file: &ModelFile,
    evaluation: &Evaluation,
) -> Result<(), Failure> {
    let wanted = arguments.false_alarms;
    if !(wanted.is_finite() && wanted > 0.0) {
        return Err(Failure::input(
            format!("--false-alarms {wanted}: a positive number per hour is needed"),
            "0.1 is one in ten hours.",
        ));
    }
    let calibration = match &arguments.calibration {
        Some(path) => {
            let options = read_options(file, arguments.drive.as_deref(), Part::Train, true)?;
            let recording = read(path, &options).map_err(|e| Failure::input(e.to_string(), ""))?;
            let options = EvaluateOptions {
                cutoff_hz: arguments.cutoff_hz,
            };
            Some(evaluate(directory, file, recording, &options)?)
        }
        None => None,
    };
    let found = of_recording(directory, file, evaluation, calibration.as_ref(), wanted)?;
    if let Some(path) = &arguments.json {
        report::write_atomic(path, json(&found))?;
    }
    if let Some(path) = &arguments.html {
        report::write_atomic(path, page(&found).render())?;
    }
    if arguments.quiet {
        return Ok(());
    }
    say!(
        "{}: {:.0} s, thresholds for {wanted} false alarms per hour from {:.0} s, in N·m (N)\n",
        evaluation.recording.source,
        found.seconds,
        found.calibration_seconds
    );
    let (thresholds, alarms) = tables(&found);
    say_text!(thresholds.to_text());
    say!();
    match alarms {
        Some(table) => say_text!(table.to_text()),
        None => say!("No alarm."),
    }
    for detector in &found.detectors {
        say!(
            "{}: {} alarms",
            detector.name.replace('_', " "),
            detector.alarms.len()
        );
    }
    for note in &found.notes {
        say_text!(report::wrapped(note, WIDTH, ""));
    }
    Ok(())
}
