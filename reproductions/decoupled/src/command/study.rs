//! `decoupled study`.

use super::json;
use crate::DecoupledError;
use crate::comau::{TABLE_1_OFFSET, TABLE_3_SPREAD};
use crate::repeats::Repeats;
use crate::simulation::Setup;
use crate::study::{AxisStudy, study};
use report::{Cell, Column, Table, say, say_text};
use std::path::PathBuf;

/// How many, how.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Runs of every axis.
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u64).range(2..=10_000))]
    draws: u64,
    /// Seed.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write the figures as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Level of Table 3's intervals.
const LEVEL: f64 = 0.999;

/// Simulates, estimates, prints.
pub fn run(arguments: &Arguments) -> Result<(), DecoupledError> {
    let made = study(arguments.draws as usize, &Setup::default(), arguments.seed)?;
    if let Some(path) = &arguments.json {
        report::write_atomic(path, json(&made))?;
    }
    say!(
        "Simulated COMAU Smart-3 S2, one axis at a time, {} runs of 20 s each at 1 kHz, unfiltered: largest bias of any\n\
         parameter, in standard errors of one estimate (its deviation over the runs).\n",
        arguments.draws
    );
    say_text!(biases(&made).to_text());
    say!("\nMaximum likelihood beside Table 3; half-widths at 99.9 % (Student)\n");
    say_text!(table_3(&made).to_text());
    say!("\nFriction from bang-bang runs: the true values are those of Table 2\n");
    say_text!(table_2(&made).to_text());
    say!("\nGravity from runs at constant speed: the true values are those of Table 3's moments\n");
    say_text!(table_1(&made).to_text());
    Ok(())
}

fn biases(made: &[AxisStudy]) -> Table {
    let names = made.first().map_or(&[][..], |a| &a.estimators[..]);
    let heads = names.iter().map(|e| Column::number(e.name));
    let mut table = Table::new(
        [Column::text("axis")]
            .into_iter()
            .chain(heads)
            .chain([Column::number("correlation"), Column::number("cond(Φ)")]),
    );
    for axis in made {
        let cells = axis
            .estimators
            .iter()
            .map(|e| Cell::significant(e.worst(), 3));
        table.push(
            [Cell::text(axis.axis.to_string())]
                .into_iter()
                .chain(cells)
                .chain([
                    Cell::text(format!("{:.1e}", axis.correlation)),
                    Cell::number(axis.condition, 1),
                ]),
        );
    }
    table
}

/// Columns of what each axis's parameters came to over the runs, `from` naming where the true values are from, then `more`.
fn columns(from: &str, more: &[&str]) -> Vec<Column> {
    let truth = format!("true ({from})");
    let numbers = [truth.as_str(), "mean", "σ"];
    let numbers = numbers.iter().chain(more).map(|head| Column::number(*head));
    let named = ["axis", "parameter"].map(Column::text);
    named.into_iter().chain(numbers).collect()
}

/// Cells of those columns for one parameter, then `more`.
fn cells(axis: usize, name: &str, truth: f64, repeats: &Repeats, more: &[Cell]) -> Vec<Cell> {
    let mut cells = vec![
        Cell::text(axis.to_string()),
        Cell::text(name),
        Cell::number(truth, 4),
        Cell::number(repeats.mean, 4),
        Cell::number(repeats.std, 4),
    ];
    cells.extend_from_slice(more);
    cells
}

/// Bias over the runs' deviation.
fn bias(truth: f64, repeats: &Repeats) -> Cell {
    Cell::number((repeats.mean - truth) / repeats.std, 2)
}

fn table_3(made: &[AxisStudy]) -> Table {
    let more = ["half-width", "stated σ", "Table 3: σ", "half-width"];
    let mut table = Table::new(columns("Table 3", &more));
    for (axis, published) in made.iter().zip(TABLE_3_SPREAD) {
        let Some(likelihood) = axis.estimators.last() else {
            continue;
        };
        for (j, [std, half]) in published.iter().enumerate() {
            let repeats = &likelihood.repeats[j];
            let (name, unit) = axis.names[j];
            let more = [
                Cell::optional(repeats.half_width(LEVEL), 4),
                Cell::number(likelihood.stated[j], 4),
                Cell::number(*std, 4),
                Cell::number(*half, 4),
            ];
            let name = format!("{name} / {unit}");
            table.push(cells(axis.axis, &name, axis.truth[j], repeats, &more));
        }
    }
    table
}

fn table_2(made: &[AxisStudy]) -> Table {
    let mut table = Table::new(columns("Table 2", &["bias / σ"]));
    for axis in made {
        let first = axis.truth.len() - 4;
        for (j, repeats) in axis.friction[1..].iter().enumerate() {
            let (name, unit) = axis.names[first + j];
            let name = format!("{name} / {unit}");
            let truth = axis.truth[first + j];
            let more = [bias(truth, repeats)];
            table.push(cells(axis.axis, &name, truth, repeats, &more));
        }
    }
    table
}

fn table_1(made: &[AxisStudy]) -> Table {
    let mut table = Table::new(columns("Table 3", &["bias / σ"]));
    for axis in made {
        let Some(moments) = &axis.gravity else {
            continue;
        };
        for (k, repeats) in moments.iter().enumerate() {
            let name = ["mx / kg·m", "my / kg·m"][k];
            let truth = axis.truth[1 + k];
            let more = [bias(truth, repeats)];
            table.push(cells(axis.axis, name, truth, repeats, &more));
        }
        if let Some((_, offset)) = TABLE_1_OFFSET.iter().find(|(a, _)| *a == axis.axis) {
            // Within a quarter of a turn, as the paper has it for either axis.
            let angle = moments[0].mean.atan2(-moments[1].mean).to_degrees();
            let angle = if angle > 45.0 { angle - 90.0 } else { angle };
            table.push([
                Cell::text(axis.axis.to_string()),
                Cell::text("q^off / ° (Table 1)"),
                Cell::number(*offset, 1),
                Cell::number(angle, 1),
                Cell::missing(),
                Cell::missing(),
            ]);
        }
    }
    table
}
