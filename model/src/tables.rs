//! Tables that train and eval print and put on their pages.

use crate::baseline::published::Published;
use crate::directory::ModelFile;
use crate::metrics::{Row, Scope};
use report::{Best, Cell, Column, Table};

/// NRMSE of every row per joint and averaged, with the mean R².
pub fn scores(joints: &[String], rows: &[Row], published: &[&Published]) -> Table {
    let mut columns = vec![Column::text("model"), Column::text("scope")];
    columns.extend(joints.iter().map(|j| Column::number(j.clone())));
    columns.push(Column::number("mean NRMSE").best(Best::Lowest));
    columns.push(Column::number("mean R² / %"));
    let mut table = Table::new(columns);
    for row in rows {
        let mut cells = vec![Cell::text(row.name.clone()), Cell::text(row.scope.name())];
        cells.extend(row.scores.nrmse.iter().map(|v| Cell::optional(*v, 4)));
        cells.push(Cell::optional(row.scores.mean_nrmse, 4));
        cells.push(Cell::optional(row.scores.mean_r2, 2));
        table.push(cells);
    }
    for p in published {
        let mut cells = vec![
            Cell::text(format!("published: {} ({:?})", p.model, p.part).to_lowercase()),
            Cell::text(Scope::All.name()),
        ];
        match p.nrmse {
            Some(list) => cells.extend(list.iter().map(|v| Cell::number(*v, 4))),
            None => cells.extend(joints.iter().map(|_| Cell::missing())),
        }
        cells.push(Cell::number(p.mean_nrmse, 4));
        cells.push(Cell::optional(p.mean_r2, 2));
        table.push(cells);
    }
    table
}

/// RMSE in N·m per joint.
pub fn errors(joints: &[String], rows: &[Row]) -> Table {
    let mut columns = vec![Column::text("model"), Column::text("scope")];
    columns.extend(joints.iter().map(|j| Column::number(format!("{j} / N·m"))));
    let mut table = Table::new(columns);
    for row in rows {
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

/// Base parameters with deviations and formulae.
pub fn base_parameters(file: &ModelFile) -> Table {
    let columns = [
        "parameter",
        "identified",
        "σ / %",
        "nominal",
        "unit",
        "formed by",
    ];
    let mut table = Table::new(columns.iter().enumerate().map(|(i, c)| {
        if (1..=3).contains(&i) {
            Column::number(*c)
        } else {
            Column::text(*c)
        }
    }));
    for p in &file.base_parameters {
        table.push([
            Cell::text(p.name.clone()),
            Cell::with_std(p.value, p.std),
            Cell::number(100.0 * (p.std / p.value).abs().min(9.99), 1),
            Cell::significant(p.nominal, 4),
            Cell::text(p.unit.clone()),
            Cell::text(p.formula.clone()),
        ]);
    }
    table
}

/// Friction and memory terms of every joint.
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
