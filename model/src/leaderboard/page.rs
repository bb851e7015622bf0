//! The board as a page and as a table for the terminal.

use super::board::{Given, Leaderboard};
use super::bootstrap::{Intervals, Judged};
use super::entry::{Entry, Training};
use crate::tables;
use report::figure::{Bars, Ink};
use report::{Best, Cell, Column, KeyFigure, Page, Section, Table};

/// Page with rows and intervals, joint by joint, sources, and explanations.
pub fn page(board: &Leaderboard) -> Page {
    let mut page = Page::new(format!("Leaderboard: torque of {}", board.robot)).subtitle(format!(
        "{} · {} samples, {} trajectories",
        board.recording, board.samples, board.trajectories
    ));
    if let Some(first) = board.rows.first() {
        page =
            page.key_figure(
                KeyFigure::new("lowest mean NRMSE", figure(first.all.scores.mean_nrmse))
                    .note(format!("{}, {}", first.model, first.origin())),
            );
    }
    page = page.section(torque(board));
    if !board.forward.is_empty() {
        page = page.section(
            Section::new("Positions from torque")
                .paragraph("The other way round: positions from the recorded torque over whole trajectories. Where there is a row physics_forward, each of its positions has seen all torque of its trajectory, later torque, too; the others are simulated from sample to sample.")
                .table(scores(&board.forward, |r| Some(&r.all)).caption("NRMSE and R² of positions")),
        );
    }
    if !board.published.is_empty() {
        page = page.section(
            Section::new("Where published rows are from").list(tables::sources(&board.published)),
        );
    }
    page.section(Section::new("How to read the figures").list(notes(board)))
        .section(given(&board.models))
        .footer(format!("residyn {}", env!("CARGO_PKG_VERSION")))
}

/// Table of the torque rows, short enough for a terminal.
pub fn table(board: &Leaderboard) -> Table {
    let mut table = Table::new([
        Column::text("model"),
        Column::text("from"),
        Column::number("mean NRMSE").best(Best::Lowest),
        Column::number("in motion").best(Best::Lowest),
        Column::number("parameters"),
        Column::number("µs"),
        Column::number("training / s"),
    ]);
    for row in &board.rows {
        table.push([
            Cell::text(row.model.clone()),
            Cell::text(row.origin()),
            nrmse(Some(&row.all)),
            nrmse(row.moving.as_ref()),
            parameters(row),
            Cell::optional(row.inference_us, 1),
            training(row.training.as_ref()),
        ]);
    }
    table
}

/// Table of the torque rows without figures measured on this machine, so that another run prints the same.
pub fn summary(board: &Leaderboard) -> Table {
    let mut table = Table::new([
        Column::text("model"),
        Column::text("from"),
        Column::number("mean NRMSE").best(Best::Lowest),
        Column::number("in motion").best(Best::Lowest),
        Column::number("parameters"),
    ]);
    for row in &board.rows {
        table.push([
            Cell::text(row.model.clone()),
            Cell::text(row.origin()),
            nrmse(Some(&row.all)),
            nrmse(row.moving.as_ref()),
            parameters(row),
        ]);
    }
    table
}

fn torque(board: &Leaderboard) -> Section {
    let costs = costs(&board.rows).caption("What each costs");
    let (names, rows) = (&board.joints, &board.rows);
    let joints = Section::new("NRMSE joint by joint")
        .table(by_joint(names, rows, |r| Some(&r.all)).caption("All samples"))
        .table(by_joint(names, rows, |r| r.moving.as_ref()).caption("In motion"));
    Section::new("Torque from motion")
        .paragraph("NRMSE is the root mean squared error over the standard deviation of the measured torque over all samples, R² = 100·(1 − NRMSE²) percent; means are over joints. “In motion” keeps, for each joint, the samples with |q̇| above 0.01 rad/s (m/s). In brackets: 95 % intervals.")
        .table(scores(rows, |r| Some(&r.all)).caption("All samples, lowest mean NRMSE first"))
        .table(scores(rows, |r| r.moving.as_ref()).caption("In motion, in the same order"))
        .figure(bars(rows))
        .table(costs)
        .details(joints)
}

/// Table of mean scores in one scope, of the rows that have it.
fn scores(rows: &[Entry], of: fn(&Entry) -> Option<&Judged>) -> Table {
    let mut table = Table::new([
        Column::text("model"),
        Column::text("from"),
        Column::number("mean NRMSE").best(Best::Lowest),
        Column::number("mean R² / %").best(Best::Highest),
    ]);
    for row in rows {
        let Some(judged) = of(row) else { continue };
        table.push([
            Cell::text(row.model.clone()),
            Cell::text(row.origin()),
            nrmse(Some(judged)),
            with_interval(judged.scores.mean_r2, judged.mean_r2_interval, 2),
        ]);
    }
    table
}

fn costs(rows: &[Entry]) -> Table {
    let mut table = Table::new([
        Column::text("model"),
        Column::text("from"),
        Column::number("parameters"),
        Column::number("µs per sample, measured now"),
        Column::number("training / s"),
    ]);
    for row in rows.iter().filter(|r| r.published.is_none()) {
        table.push([
            Cell::text(row.model.clone()),
            Cell::text(row.origin()),
            parameters(row),
            Cell::optional(row.inference_us, 1),
            training(row.training.as_ref()),
        ]);
    }
    table
}

fn by_joint(joints: &[String], rows: &[Entry], of: fn(&Entry) -> Option<&Judged>) -> Table {
    let mut columns = vec![Column::text("model"), Column::text("from")];
    columns.extend(
        joints
            .iter()
            .map(|j| Column::number(j.clone()).best(Best::Lowest)),
    );
    let mut table = Table::new(columns);
    for row in rows {
        let Some(judged) = of(row) else { continue };
        let mut cells = vec![Cell::text(row.model.clone()), Cell::text(row.origin())];
        cells.extend(
            judged
                .scores
                .nrmse
                .iter()
                .zip(&judged.nrmse_interval)
                .map(|(value, interval)| with_interval(*value, *interval, 4)),
        );
        table.push(cells);
    }
    table
}

/// Figure of every row's mean NRMSE with its interval, in the table's order.
fn bars(rows: &[Entry]) -> report::Figure {
    let some = |r: &&Entry| r.all.scores.mean_nrmse.is_some();
    let names = rows.iter().filter(some);
    let names: Vec<String> = names
        .map(|r| format!("{}, {}", r.model, r.origin()))
        .collect();
    let values: Vec<(f64, [f64; 2])> = rows
        .iter()
        .filter_map(|r| {
            let none = [f64::NAN; 2];
            let interval = r.all.mean_nrmse_interval.unwrap_or(none);
            Some((r.all.scores.mean_nrmse?, interval))
        })
        .collect();
    Bars::new("Mean NRMSE over all samples", "NRMSE", names)
        .decimals(4)
        .series_with_intervals("mean NRMSE, 95 % interval", Ink::Predicted, &values)
        .draw("Mean NRMSE of every model over all samples, with 95 % intervals where they can be drawn")
}

fn notes(board: &Leaderboard) -> Vec<String> {
    let fixed = [
        "Published rows come without intervals, figures in motion and costs. Their protocols differ: the list of sources says how.",
        "Parameters: those of the physics (base parameters and terms; constants chosen from a grid, such as Stribeck velocities, are not counted), of the linear baseline its matrix, after the plus sign the weights of all networks that are on.",
        "µs per sample: median of one call of the control loop's function on this machine, one thread, measured when this page was made. It is the only figure that another run does not repeat.",
        "Training: wall time of identification and networks as timing.json beside the model has it; “>” where an interrupted run was gone on with, “–” where nothing was noted.",
        "physics+ridge, physics+trees: yardsticks of train --yardsticks, ridge regression and boosted trees on the same inputs in place of the networks. They are no part of a model that runs; after the plus sign stand the ridge's weights and the trees' leaves.",
        "Rows of several directories have the same figures in all of them. “Fitted on it”: the model saw this very recording, so its figures say nothing about new motion.",
    ];
    let first = std::iter::once(over(&board.intervals));
    first.chain(fixed.map(str::to_owned)).collect()
}

/// Explanation of the intervals as text.
fn over(intervals: &Intervals) -> String {
    let (draws, stretches, seed) = (intervals.draws, intervals.stretches, intervals.seed);
    let how = format!(
        "Intervals of 95 %: percentiles of {draws} recordings drawn with replacement (seed {seed}) from"
    );
    match intervals.over {
        "blocks" => format!(
            "{how} {stretches} consecutive blocks: the recording has too few trajectories to draw from. Blocks resemble their neighbours, so these intervals are too narrow for motions of another kind."
        ),
        _ => format!(
            "{how} its {stretches} trajectories, the same draws for every model. Models of the same recording share its accidents: intervals that overlap may still differ surely."
        ),
    }
}

fn given(models: &[Given]) -> Section {
    let section = Section::new("Models given");
    models.iter().fold(section, |section, model| {
        section.details(Section::new(model.directory.clone()).list(model.notes.clone()))
    })
}

fn figure(value: Option<f64>) -> String {
    value.map_or_else(|| "–".into(), |v| format!("{v:.4}"))
}

fn with_interval(value: Option<f64>, interval: Option<[f64; 2]>, decimals: usize) -> Cell {
    value.map_or_else(Cell::missing, |v| {
        Cell::with_interval(v, interval, decimals)
    })
}

fn nrmse(judged: Option<&Judged>) -> Cell {
    judged.map_or_else(Cell::missing, |j| {
        with_interval(j.scores.mean_nrmse, j.mean_nrmse_interval, 4)
    })
}

fn parameters(row: &Entry) -> Cell {
    match (row.parameters, row.network_parameters) {
        (None, _) => Cell::missing(),
        (Some(n), None) => Cell::text(n.to_string()),
        (Some(n), Some(network)) => Cell::text(format!("{n} + {network}")),
    }
}

fn training(training: Option<&Training>) -> Cell {
    training.map_or_else(Cell::missing, |t| {
        let more = if t.whole { "" } else { "> " };
        let threads = if t.threads == 1 { "thread" } else { "threads" };
        Cell::text(format!("{more}{:.1}, {} {threads}", t.seconds, t.threads))
    })
}
