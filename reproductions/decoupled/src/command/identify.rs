//! `decoupled identify`.

use super::json;
use crate::DecoupledError;
use crate::estimators::{ALL, Estimate};
use crate::joint::Columns;
use crate::run::Run;
use report::{Cell, Column, Table, say, say_text};
use std::path::PathBuf;

/// Which joint, from what.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Recording of a periodic motion of one joint, with q_ref1 … (.csv, .parquet, .npz).
    #[arg(long, value_name = "REC")]
    data: PathBuf,
    /// Joint, from 1.
    #[arg(long, default_value_t = 1)]
    axis: usize,
    /// Fundamental frequency of the commanded motion, Hz.
    #[arg(long, value_name = "F", default_value_t = 0.1, value_parser = positive)]
    fundamental_hz: f64,
    /// Its harmonics.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u64).range(1..=100))]
    harmonics: u64,
    /// Gravity does no work about the joint: its axis is upright.
    #[arg(long)]
    upright: bool,
    /// Average over the periods, Chebyshev low-pass at 80 Hz, thinned to 200 Hz, as the paper does.
    #[arg(long)]
    as_published: bool,
    /// Write the estimates as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

fn positive(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("a number above zero is needed".into()),
    }
}

#[derive(serde::Serialize)]
struct Written<'a> {
    schema: &'static str,
    parameters: Vec<(&'static str, &'static str)>,
    estimates: Vec<(&'static str, &'a Estimate)>,
}

/// Reads, estimates by each, writes, prints.
pub fn run(arguments: &Arguments) -> Result<(), DecoupledError> {
    let harmonics = arguments.harmonics as usize;
    let run = Run::periodic(
        &arguments.data,
        arguments.axis,
        arguments.fundamental_hz,
        harmonics,
    )?;
    let (run, repeats) = if arguments.as_published {
        run.as_published()?
    } else {
        (run, None)
    };
    let columns = Columns {
        gravity: !arguments.upright,
    };
    let estimates = ALL
        .iter()
        .map(|e| Ok((*e, e.estimate(&run, columns, &|_| 0.0)?)))
        .collect::<Result<Vec<_>, DecoupledError>>()?;
    if let Some(path) = &arguments.json {
        let written = Written {
            schema: "decoupled/1",
            parameters: columns.names(),
            estimates: estimates
                .iter()
                .map(|(e, found)| (e.name(), found))
                .collect(),
        };
        report::write_atomic(path, json(&written))?;
    }
    say!(
        "{}: {} samples, axis {}\n",
        run.source,
        run.len(),
        arguments.axis
    );
    if let Some([position, torque]) = repeats {
        say!(
            "One period differs from the average by {position:.2e} rad and {torque:.2e} N·m (deviation).\n"
        );
    }
    let heads = estimates.iter().map(|(e, _)| Column::number(e.name()));
    let mut table = Table::new([Column::text("parameter")].into_iter().chain(heads));
    for (j, (name, unit)) in columns.names().into_iter().enumerate() {
        let cells = estimates
            .iter()
            .map(|(_, e)| Cell::with_std(e.parameters[j], e.std[j]));
        table.push(
            [Cell::text(format!("{name} / {unit}"))]
                .into_iter()
                .chain(cells),
        );
    }
    say_text!(table.to_text());
    say!();
    for (estimator, found) in &estimates {
        say!("{}: {}.", estimator.name(), estimator.words());
        if let Some(correlation) = found.correlation {
            say!("  correlation of the projected torque with what is left: {correlation:.1e}");
        }
        if let Some(noise) = found.noise {
            say!(
                "  noise: {:.2e} rad of position, {:.2e} N·m of torque",
                noise.position,
                noise.torque
            );
        }
    }
    Ok(())
}
