//! `decoupled friction`.

use crate::DecoupledError;
use crate::friction;
use crate::gravity::Gravity;
use crate::joint::Columns;
use crate::run::Run;
use report::{Cell, Column, Table, say, say_text};
use std::path::PathBuf;

/// Which joint, from what.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Recording of bang-bang acceleration, with q_ref1 … and qd_ref1 ….
    #[arg(long, value_name = "REC")]
    bang_bang: PathBuf,
    /// Recording at constant speed there and back; without it gravity counts as none: an upright axis.
    #[arg(long, value_name = "REC")]
    slopes: Option<PathBuf>,
    /// Joint, from 1.
    #[arg(long, default_value_t = 1)]
    axis: usize,
}

/// Reads, estimates, prints.
pub fn run(arguments: &Arguments) -> Result<(), DecoupledError> {
    let gravity = arguments
        .slopes
        .as_ref()
        .map(|path| Gravity::of(&Run::commanded(path, arguments.axis)?))
        .transpose()?;
    let run = Run::commanded(&arguments.bang_bang, arguments.axis)?;
    let found = friction::of(&run, gravity.as_ref())?;
    let mut table = Table::new([Column::text("parameter"), Column::number("value")]);
    if let Some(gravity) = &gravity {
        for (name, k) in [("mx / kg·m", 0), ("my / kg·m", 1)] {
            let value = Cell::with_std(gravity.moments[k], gravity.std[k]);
            table.push([Cell::text(name), value]);
        }
        let [k, offset] = gravity.sine();
        table.push([Cell::text("k / N·m"), Cell::significant(k, 5)]);
        table.push([
            Cell::text("q^off / °"),
            Cell::number(offset.to_degrees(), 2),
        ]);
    }
    let names = Columns { gravity: false }.names();
    for ((name, unit), (value, std)) in names
        .into_iter()
        .zip(found.parameters.iter().zip(&found.std))
    {
        table.push([
            Cell::text(format!("{name} / {unit}")),
            Cell::with_std(*value, *std),
        ]);
    }
    say!("{}: axis {}\n", run.source, arguments.axis);
    say_text!(table.to_text());
    Ok(())
}
