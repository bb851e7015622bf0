//! The steps of the program.

use crate::arguments::Arguments;
use crate::screen;
use datasets::{Part, read};
use model::directory::{ModelFile, json};
use model::evaluation::read_options;
use model::failure::Failure;
use model::payload::{PayloadOptions, estimate};

/// Reads, estimates, writes, prints.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let file = ModelFile::load(&arguments.model)?;
    let options = read_options(&file, arguments.drive.as_deref(), Part::Train, true)?;
    let recording =
        read(&arguments.data, &options).map_err(|e| Failure::input(e.to_string(), ""))?;
    let options = PayloadOptions {
        cutoff_hz: arguments.cutoff_hz,
        friction_change: arguments.friction_change,
    };
    let found = estimate(&file, &recording, &options)?;
    if let Some(path) = &arguments.json {
        report::write_atomic(path, json(&found))?;
    }
    if !arguments.quiet {
        screen::print(&found, &recording.source);
    }
    Ok(())
}
