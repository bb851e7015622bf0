//! `machine eval`.

use super::Given;
use crate::MachineError;
use crate::identification::ALLOWED;
use crate::prediction::{Prediction, Scores, predict, score};
use crate::store::MachineFile;
use report::{Cell, Column, Table, say, say_text};
use std::fmt::Write;
use std::path::PathBuf;

/// Which machine, on what.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    given: Given,
    /// Write the scores as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write predicted torque as CSV; the recording needs no torque.
    #[arg(long)]
    predict: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

/// Predicts, scores where there is torque, writes, prints.
pub fn run(arguments: &Arguments) -> Result<(), MachineError> {
    let (file, data) = arguments.given.read(arguments.predict.is_none())?;
    let prediction = predict(&file, &data)?;
    let scores = match data.tau {
        Some(_) => Some(score(&file, &data, &prediction)?),
        None => None,
    };
    if let (Some(path), Some(scores)) = (&arguments.json, &scores) {
        let mut text = serde_json::to_string_pretty(scores).unwrap_or_default();
        text.push('\n');
        report::write_atomic(path, text)?;
    }
    if let Some(path) = &arguments.predict {
        report::write_atomic(path, csv(&data, &prediction))?;
    }
    if let (Some(scores), false) = (&scores, arguments.quiet) {
        print(&file, scores, &data.source);
    }
    Ok(())
}

fn csv(data: &datasets::Recording, prediction: &Prediction) -> String {
    let mut out = String::from("trajectory,time");
    for j in 1..=prediction.torque.ncols() {
        let _ = write!(out, ",tau{j}");
    }
    out.push('\n');
    for trajectory in &data.trajectories {
        for row in trajectory.range.clone() {
            let _ = write!(out, "{},{}", trajectory.label, data.time[row]);
            for torque in prediction.torque.row(row) {
                let _ = write!(out, ",{torque}");
            }
            out.push('\n');
        }
    }
    out
}

fn print(file: &MachineFile, scores: &Scores, source: &str) {
    say!(
        "{source}: {} samples, machine {}, dynamic model {}\n",
        scores.samples,
        file.machine.name,
        file.machine.dynamic_model
    );
    let mut table = Table::new([
        Column::text("axis"),
        Column::number("RMSE"),
        Column::text("unit"),
        Column::number("RMSE / RMS torque / %"),
        Column::number("NRMSE"),
        Column::number("max error / %"),
        Column::number("mean error / %"),
    ]);
    let percent =
        |value: Option<f64>| Cell::optional(value.filter(|v| v.is_finite()).map(|v| 100.0 * v), 2);
    for (j, axis) in scores.axes.iter().enumerate() {
        let all = &scores.rows[0].scores;
        table = table.row([
            Cell::text(&axis.name),
            all.rmse[j].map_or_else(Cell::missing, |v| Cell::significant(v, 3)),
            Cell::text(file.machine.axis[j].effort_unit()),
            percent(scores.relative_rms[j]),
            Cell::optional(all.nrmse[j], 4),
            percent(Some(axis.max_relative)),
            percent(Some(axis.mean_relative)),
        ]);
    }
    say_text!(table.to_text());
    let still = scores.axes.iter().find(|a| a.max_relative.is_nan());
    let verdict = match still {
        _ if scores.axes.iter().any(|a| a.max_relative > ALLOWED) => "beyond 50 %".to_owned(),
        Some(axis) => format!("not to be told, {} never moves", axis.name),
        None => "within 50 %".to_owned(),
    };
    say!(
        "RMSE over all samples against the torque as recorded; max and mean error by the rule of the identification: {verdict}"
    );
}
