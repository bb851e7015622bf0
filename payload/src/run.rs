//! The steps of the program.

use crate::arguments::Arguments;
use crate::screen;
use datasets::{Part, Recording, read};
use model::directory::{ModelFile, json};
use model::evaluation::read_options;
use model::failure::Failure;
use model::payload::gains::{self, GainOptions, KnownBody};
use model::payload::{PayloadOptions, estimate};
use std::path::Path;

/// Reads, estimates, writes, prints.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let file = ModelFile::load(&arguments.model)?;
    match (&arguments.known, &arguments.without) {
        (Some(known), Some(without)) => drives(arguments, &file, known, without),
        _ => body(arguments, &file),
    }
}

/// The body from a model without it.
fn body(arguments: &Arguments, file: &ModelFile) -> Result<(), Failure> {
    let recording = recorded(arguments, file, &arguments.data)?;
    let options = PayloadOptions {
        cutoff_hz: arguments.cutoff_hz,
        friction_change: arguments.friction_change,
    };
    let found = estimate(file, &recording, &options)?;
    write(arguments, json(&found))?;
    if !arguments.quiet {
        screen::print(&found, &recording.source);
    }
    Ok(())
}

/// The drives' gains from a body that is known.
fn drives(
    arguments: &Arguments,
    file: &ModelFile,
    known: &KnownBody,
    without: &Path,
) -> Result<(), Failure> {
    let without = recorded(arguments, file, without)?;
    let with = recorded(arguments, file, &arguments.data)?;
    let options = GainOptions {
        cutoff_hz: arguments.cutoff_hz,
        ..GainOptions::default()
    };
    let found = gains::estimate(file, &without, &with, known, &options)?;
    write(arguments, json(&found))?;
    if !arguments.quiet {
        screen::print_gains(&found, [&without.source, &with.source]);
    }
    Ok(())
}

fn recorded(arguments: &Arguments, file: &ModelFile, path: &Path) -> Result<Recording, Failure> {
    let options = read_options(file, arguments.drive.as_deref(), Part::Train, true)?;
    read(path, &options).map_err(|e| Failure::input(e.to_string(), ""))
}

fn write(arguments: &Arguments, text: String) -> Result<(), Failure> {
    if let Some(path) = &arguments.json {
        report::write_atomic(path, text)?;
    }
    Ok(())
}
