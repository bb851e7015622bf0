//! Tables that train and eval print and show on their pages.

mod identification;
mod overview;

pub use identification::{
    base_parameters, conditioning, cutoffs, estimator, links, residual_tests,
};
pub use overview::{errors_by_joint, friction};

use crate::baseline::FORWARD;
use crate::baseline::published::{Published, Task};
use crate::directory::ModelFile;
use datasets::metrics::{Row, Scope};
use report::{Cell, Column, Table};

/// Name of the row of physics with ridge regression instead of the compensator.
pub const RIDGE: &str = "physics+ridge";
/// Name of the row of physics with boosted trees instead of the compensator.
pub const TREES: &str = "physics+trees";

/// Whether a row of scores is that of a yardstick, which the model does not contain.
fn is_yardstick(row: &Row) -> bool {
    row.name == RIDGE || row.name == TREES
}

/// Whether a row is about positions simulated from torque.
fn is_forward(row: &Row) -> bool {
    row.name.starts_with(FORWARD)
}

/// Table of NRMSE of every torque row per joint and averaged, with the mean R².
pub fn scores(joints: &[String], rows: &[Row], published: &[&Published]) -> Table {
    let rows = rows.iter().filter(|row| !is_forward(row));
    let published = published.iter().filter(|p| p.task == Task::Inverse);
    normalised(joints, rows, published).unwrap_or_default()
}

/// Table of NRMSE of positions simulated from torque; none where no row is on positions.
pub fn forward(joints: &[String], rows: &[Row], published: &[&Published]) -> Option<Table> {
    let rows = rows.iter().filter(|row| is_forward(row));
    let published = published.iter().filter(|p| p.task == Task::Forward);
    normalised(joints, rows, published)
}

fn normalised<'a>(
    joints: &[String],
    rows: impl Iterator<Item = &'a Row>,
    published: impl Iterator<Item = &'a &'a Published>,
) -> Option<Table> {
    let mut columns = vec![Column::text("model"), Column::text("scope")];
    columns.extend(joints.iter().map(|j| Column::number(j.clone())));
    columns.push(Column::number("mean NRMSE"));
    columns.push(Column::number("mean R² / %"));
    let mut table = Table::new(columns);
    let mut some = false;
    for row in rows {
        some = true;
        let mut cells = vec![Cell::text(row.name.clone()), Cell::text(row.scope.name())];
        cells.extend(row.scores.nrmse.iter().map(|v| Cell::optional(*v, 4)));
        cells.push(Cell::optional(row.scores.mean_nrmse, 4));
        cells.push(Cell::optional(row.scores.mean_r2, 2));
        table.push(cells);
    }
    for p in published {
        let mut cells = vec![
            Cell::text(format!("published, {}: {}", p.part.name(), p.model)),
            Cell::text(Scope::All.name()),
        ];
        match p.nrmse {
            Some(list) => cells.extend(list.iter().map(|v| Cell::number(*v, 3))),
            None => cells.extend(joints.iter().map(|_| Cell::missing())),
        }
        cells.push(Cell::number(p.mean_nrmse, 4));
        cells.push(Cell::optional(p.mean_r2, 2));
        table.push(cells);
    }
    some.then_some(table)
}

/// Lines with the source of each published row, and its inputs where they deviate from the protocol.
pub fn sources(published: &[&Published]) -> Vec<String> {
    let line = |p: &&Published| {
        let (model, part, source) = (p.model, p.part.name(), p.source);
        match p.protocol {
            "" => format!("{model}, {part}: {source}"),
            protocol => format!("{model}, {part}: {source} ({protocol})"),
        }
    };
    published.iter().map(line).collect()
}

/// Table of RMSE of torque per joint, N·m (N).
pub fn errors(joints: &[String], rows: &[Row]) -> Table {
    let mut columns = vec![Column::text("model"), Column::text("scope")];
    columns.extend(joints.iter().map(|j| Column::number(format!("{j} / N·m"))));
    let mut table = Table::new(columns);
    for row in rows.iter().filter(|row| !is_forward(row)) {
        let mut cells = vec![Cell::text(row.name.clone()), Cell::text(row.scope.name())];
        cells.extend(
            row.scores
                .rmse
                .iter()
                .map(|v| v.map_or_else(Cell::missing, |v| Cell::significant(v, 4))),
        );
        table.push(cells);
    }
    table
}

/// Table of friction and memory terms of every joint.
pub fn terms(file: &ModelFile) -> Table {
    let mut table = Table::new([
        Column::text("joint"),
        Column::text("term"),
        Column::text("effect"),
        Column::number("value"),
        Column::text("unit"),
    ]);
    for (joint, list) in file.joints.iter().zip(&file.physics.terms) {
        for w in list {
            table.push([
                Cell::text(joint.clone()),
                Cell::text(w.term.label()),
                Cell::text(w.term.effect()),
                if w.std > 0.0 {
                    Cell::with_std(w.value, w.std)
                } else {
                    Cell::significant(w.value, 4)
                },
                Cell::text(w.term.unit()),
            ]);
        }
    }
    table
}
