//! `machine identify`.

use crate::description::Description;
use crate::identification::{Identified, Settings, identify};
use crate::program::{Extras, program};
use crate::recorder::recorder;
use crate::store::{FILE, MachineFile};
use crate::{Machine, MachineError, reasons, recording};
use report::{Cell, Column, Table, say, say_text};
use std::path::PathBuf;

/// What to identify, from what.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Machine: a built-in name or a description (.toml).
    #[arg(long)]
    robot: String,
    /// Recording (.csv, .parquet, .npz).
    #[arg(long)]
    data: PathBuf,
    /// Drive file: names and units of columns, torque factors, delays, thresholds.
    #[arg(long)]
    drive: Option<PathBuf>,
    /// Torque model of the machine's kind [default: the description's].
    #[arg(long)]
    dynamic_model: Option<usize>,
    /// Cut-off of the low-pass of position and torque, Hz.
    #[arg(long, default_value_t = crate::identification::FILTER_HZ)]
    filter_hz: f64,
    /// Speed below which an axis's samples are left out, one per axis, rad/s or m/s [default: a tenth of its highest].
    #[arg(long, value_delimiter = ',')]
    threshold: Option<Vec<f64>>,
    /// Speed above which the semi-static model leaves samples out, one per axis [default: 0.15 of the axis's limit].
    #[arg(long, value_delimiter = ',')]
    ceiling: Option<Vec<f64>>,
    /// Folder for machine.json, IDNT1.PRG and IDNT1.REC.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Write machine.json to this place as well.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Date and time to stand in the program.
    #[arg(long)]
    date: Option<String>,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

/// Identifies, writes the results, prints them.
pub fn run(arguments: &Arguments) -> Result<(), MachineError> {
    let mut description = Description::load(&arguments.robot)?;
    if let Some(number) = arguments.dynamic_model {
        description.dynamic_model = number;
    }
    let drive = arguments
        .drive
        .as_deref()
        .map(|path| recording::drive(path, &description))
        .transpose()?;
    let machine = Machine::new(description.clone())?;
    let data = recording::recording(&arguments.data, &description, drive.as_ref(), true)?;
    let settings = Settings {
        filter_hz: Some(arguments.filter_hz),
        thresholds: arguments.threshold.clone(),
        ceilings: arguments.ceiling.clone(),
    };
    let identified = identify(machine, &data, &settings)?;
    let reasons = reasons::find(&identified, &data)?;
    let file = MachineFile::of(&identified, reasons, drive.as_ref());
    if let Some(out) = &arguments.out {
        super::folder(out)?;
        let extras = Extras {
            date: arguments.date.as_deref(),
            drive: drive.as_ref(),
        };
        report::write_atomic(&out.join("IDNT1.PRG"), program(&identified, &extras))?;
        report::write_atomic(&out.join("IDNT1.REC"), recorder(&identified))?;
        report::write_atomic(&out.join(FILE), file.json())?;
    }
    if let Some(path) = &arguments.json {
        report::write_atomic(path, file.json())?;
    }
    if !arguments.quiet {
        print(&identified, &file);
        if let Some(out) = &arguments.out {
            say!(
                "Written: {} (machine.json, IDNT1.PRG, IDNT1.REC)",
                out.display()
            );
        }
    }
    Ok(())
}

/// Width of a line for a person.
const WIDTH: usize = 100;

fn print(identified: &Identified, file: &MachineFile) {
    let description = identified.machine.description();
    say!(
        "{}, dynamic model {}: identification {} (largest relative torque error at most 50 % on every axis)",
        description.name,
        description.dynamic_model,
        if file.success { "succeeded" } else { "failed" }
    );
    let [recorded, kept] = file.samples;
    say!(
        "{kept} of {recorded} samples, low-pass {} Hz\n",
        file.filter_hz
    );
    let mut axes = Table::new([
        Column::text("axis"),
        Column::number("max error / %"),
        Column::number("mean error / %"),
        Column::number("RMS error"),
        Column::number("samples in motion"),
        Column::number("threshold"),
    ]);
    for (axis, described) in file.axes.iter().zip(&description.axis) {
        axes = axes.row([
            Cell::text(format!("{} ({})", axis.name, described.effort_unit())),
            Cell::number(100.0 * axis.max_relative, 2),
            Cell::number(100.0 * axis.mean_relative, 2),
            Cell::significant(axis.rms, 3),
            Cell::number(axis.samples as f64, 0),
            Cell::significant(axis.band.lower, 3),
        ]);
    }
    say_text!(axes.to_text());
    say!();
    let mut parameters = Table::new([
        Column::text("parameter"),
        Column::number("value ± deviation"),
        Column::text("unit"),
    ]);
    for p in &file.parameters {
        parameters = parameters.row([
            Cell::text(&p.name),
            Cell::with_std(p.value, p.std),
            Cell::text(&p.unit),
        ]);
    }
    say_text!(parameters.to_text());
    for derived in &file.derived {
        say!("{}: {:.4} {}", derived.name, derived.value, derived.unit);
    }
    if file.rank < file.parameters.len() {
        let line = format!(
            "The motion tells {} combinations of {} parameters: single values may be conventions, their torque is not.",
            file.rank,
            file.parameters.len()
        );
        say_text!(report::wrapped(&line, WIDTH, ""));
    }
    for (axis, torque) in file.additive.beyond(&identified.command) {
        say!(
            "{} needs up to {torque:.1} of additive torque, beyond its torque_threshold: the controller would refuse it.",
            file.axes[axis].name
        );
    }
    if !file.reasons.is_empty() {
        say!(
            "\n{}",
            if file.success {
                "To look at, although it succeeded:"
            } else {
                "What explains it:"
            }
        );
        for reason in &file.reasons {
            say_text!(report::wrapped(&format!("- {}", reason.message), WIDTH, ""));
        }
    }
}
