//! `machine payload`: the folder is of the machine without the body, the recording with it.

use super::Given;
use crate::MachineError;
use crate::payload::{MachinePayload, estimate};
use crate::store::MachineFile;
use report::{Cell, Column, Table, say, say_text};
use std::path::PathBuf;

/// Which machine, with what.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    given: Given,
    /// Write the figures as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

/// Estimates, writes, prints.
pub fn run(arguments: &Arguments) -> Result<(), MachineError> {
    let (file, data) = arguments.given.read(true)?;
    let found = estimate(&file, &data)?;
    if let Some(path) = &arguments.json {
        let mut text = serde_json::to_string_pretty(&found).unwrap_or_default();
        text.push('\n');
        report::write_atomic(path, text)?;
    }
    if !arguments.quiet {
        print(&file, &found, &data.source);
    }
    Ok(())
}

fn print(file: &MachineFile, found: &MachinePayload, source: &str) {
    say!(
        "{source}: the body on the last axis of {}, dynamic model {}\n",
        found.machine,
        found.dynamic_model
    );
    let mut table = Table::new([
        Column::text("figure"),
        Column::number("value"),
        Column::number("deviation"),
        Column::text("unit"),
    ]);
    for figure in &found.body {
        table.push([
            Cell::text(&figure.name),
            Cell::significant(figure.value, 4),
            Cell::significant(figure.std, 2),
            Cell::text(&figure.unit),
        ]);
    }
    say_text!(table.to_text());
    say!();
    // Nothing of an axis that never moved.
    let size = |rms: f64| match rms.is_finite() {
        true => Cell::significant(rms, 3),
        false => Cell::missing(),
    };
    let mut table = Table::new([
        Column::text("axis"),
        Column::number("RMS left without it"),
        Column::number("with it"),
        Column::text("unit"),
    ]);
    for (j, axis) in file.machine.axis.iter().enumerate() {
        table.push([
            Cell::text(&axis.name),
            size(found.rms_without[j]),
            size(found.rms_with[j]),
            Cell::text(axis.effort_unit()),
        ]);
    }
    say_text!(table.to_text());
}
