//! `decoupled study`.

use super::json;
use decoupled::DecoupledError;
use decoupled::comau::{TABLE_1_OFFSET, TABLE_3_SPREAD};
use decoupled::repeats::Repeats;
use decoupled::simulation::Setup;
use decoupled::study::{AxisStudy, study};
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

fn table_3(made: &[AxisStudy]) -> Table {
    let mut table = Table::new([
        Column::text("axis"),
        Column::text("parameter"),
        Column::number("true (Table 3)"),
        Column::number("mean"),
        Column::number("σ"),
        Column::number("half-width"),
        Column::number("stated σ"),
        Column::number("Table 3: σ"),
        Column::number("half-width"),
    ]);
    for (axis, published) in made.iter().zip(TABLE_3_SPREAD) {
        let Some(likelihood) = axis.estimators.last() else {
            continue;
        };
        for (j, [std, half]) in published.iter().enumerate() {
            let repeats = likelihood.repeats[j];
            let (name, unit) = axis.names[j];
            table.push([
                Cell::text(axis.axis.to_string()),
                Cell::text(format!("{name} / {unit}")),
                Cell::number(axis.truth[j], 4),
                Cell::number(repeats.mean, 4),
                Cell::number(repeats.std, 4),
                Cell::optional(repeats.half_width(LEVEL), 4),
                Cell::number(likelihood.stated[j], 4),
                Cell::number(*std, 4),
                Cell::number(*half, 4),
            ]);
        }
    }
    table
}

fn table_2(made: &[AxisStudy]) -> Table {
    let mut table = Table::new([
        Column::text("axis"),
        Column::text("parameter"),
        Column::number("true (Table 2)"),
        Column::number("mean"),
        Column::number("σ"),
        Column::number("bias / σ"),
    ]);
    for axis in made {
        let first = axis.truth.len() - 4;
        for (j, repeats) in axis.friction[1..].iter().enumerate() {
            let (name, unit) = axis.names[first + j];
            table.push(row(
                axis.axis,
                &format!("{name} / {unit}"),
                axis.truth[first + j],
                repeats,
            ));
        }
    }
    table
}

fn table_1(made: &[AxisStudy]) -> Table {
    let mut table = Table::new([
        Column::text("axis"),
        Column::text("parameter"),
        Column::number("true (Table 3)"),
        Column::number("mean"),
        Column::number("σ"),
        Column::number("bias / σ"),
    ]);
    for axis in made {
        let Some(moments) = &axis.gravity else {
            continue;
        };
        for (k, repeats) in moments.iter().enumerate() {
            let name = ["mx / kg·m", "my / kg·m"][k];
            table.push(row(axis.axis, name, axis.truth[1 + k], repeats));
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

fn row(axis: usize, name: &str, truth: f64, repeats: &Repeats) -> [Cell; 6] {
    [
        Cell::text(axis.to_string()),
        Cell::text(name),
        Cell::number(truth, 4),
        Cell::number(repeats.mean, 4),
        Cell::number(repeats.std, 4),
        Cell::number((repeats.mean - truth) / repeats.std, 2),
    ]
}
