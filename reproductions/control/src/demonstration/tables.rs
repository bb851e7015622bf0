//! Tables of a closed loop.

use super::experiment::{Demonstration, Experiment};
use report::{Best, Cell, Column, Table};

/// Errors of every mode: RMS of each joint, all joints, tool, settling.
pub fn errors(experiment: &Experiment) -> Table {
    let mut columns = vec![Column::text("mode")];
    for (name, unit) in experiment.joints.iter().zip(&experiment.units) {
        columns.push(Column::number(format!("{name} / m{unit}")).best(Best::Lowest));
    }
    let alike = experiment.units.iter().all(|u| *u == experiment.units[0]);
    if alike {
        columns.push(Column::number("RMS of all").best(Best::Lowest));
    }
    columns.push(Column::number("peak of any"));
    let tool = experiment
        .outcomes
        .iter()
        .any(|o| o.tracking.tool.is_some());
    if tool {
        columns.push(Column::number("tool RMS / mm").best(Best::Lowest));
        columns.push(Column::number("tool peak / mm"));
    }
    if experiment.settle.is_some() {
        columns.push(Column::number("settled after / ms").best(Best::Lowest));
    }
    let mut table =
        Table::new(columns).caption(format!("{}: {}", experiment.robot, experiment.motion));
    for outcome in &experiment.outcomes {
        let tracking = &outcome.tracking;
        let mut row = vec![Cell::text(outcome.mode.words())];
        row.extend(
            tracking
                .joints
                .iter()
                .map(|e| Cell::significant(1e3 * e.rms, 3)),
        );
        if alike {
            row.push(Cell::significant(1e3 * tracking.rms(), 3));
        }
        let peak = tracking.joints.iter().map(|e| e.peak).fold(0.0, f64::max);
        row.push(Cell::significant(1e3 * peak, 3));
        if let (true, Some(errors)) = (tool, &tracking.tool) {
            row.push(Cell::significant(1e3 * errors.rms, 3));
            row.push(Cell::significant(1e3 * errors.peak, 3));
        }
        if experiment.settle.is_some() {
            row.push(Cell::optional(tracking.settling.map(|s| 1e3 * s), 0));
        }
        table.push(row);
    }
    table
}

/// Published figures beside ours; none where nothing is published.
pub fn compared(demonstration: &Demonstration) -> Option<Table> {
    let mut table = Table::new([
        Column::text("robot"),
        Column::text("figure"),
        Column::number("published, without"),
        Column::number("with"),
        Column::number("ratio"),
        Column::number("here, cascade alone"),
        Column::number("physics"),
        Column::number("ratio"),
    ]);
    let mut any = false;
    for experiment in &demonstration.experiments {
        let Some(compared) = &experiment.published else {
            continue;
        };
        any = true;
        let ([without, with], [ours, better]) = (compared.published, compared.ours);
        table.push([
            Cell::text(&experiment.robot),
            Cell::text(compared.figure),
            Cell::significant(without, 3),
            Cell::significant(with, 3),
            Cell::number(with / without, 2),
            ours.map_or_else(Cell::missing, |v| Cell::significant(v, 3)),
            better.map_or_else(Cell::missing, |v| Cell::significant(v, 3)),
            Cell::optional(better.zip(ours).map(|(b, o)| b / o), 2),
        ]);
    }
    any.then_some(table)
}
