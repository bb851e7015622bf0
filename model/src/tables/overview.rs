//! Overview tables: each joint's friction, and its errors beside the baseline's.

use super::{is_forward, is_yardstick};
use crate::directory::ModelFile;
use crate::identify::steady::{steady, top_speed};
use datasets::metrics::{Row, Scope};
use physics::effects::Term;
use physics::torque_model::WeightedTerm;
use report::{Cell, Column, Table};
use signal::Motion;

/// Largest number of effects that are named per joint.
const NAMED: usize = 2;
/// Largest number of models beside each other in the table.
const MODELS: usize = 5;
/// Effects that every joint has.
const BASIC: [&str; 3] = ["torque_offset", "friction_parameters", "rotor_inertia"];

/// Table of every joint's friction, N·m (N), at its top speed, rad/s (m/s), and at a tenth of it: mean of both
/// directions, without load. Beside it the effects found beyond viscous and Coulomb friction. `motions` are
/// those of the training.
pub fn friction(file: &ModelFile, motions: &[&Motion]) -> Table {
    let mut table = Table::new([
        Column::text("joint"),
        Column::number("speed"),
        Column::number("friction"),
        Column::number("slow"),
        Column::text("beside Coulomb and viscous"),
    ]);
    for (j, (joint, list)) in file.joints.iter().zip(&file.physics.terms).enumerate() {
        let top = top_speed(motions.iter().copied(), j);
        let weighted: Vec<(Term, f64)> = list.iter().map(|w| (w.term.clone(), w.value)).collect();
        let at = |share: f64| {
            top.map_or_else(Cell::missing, |v| {
                Cell::significant(steady(&weighted, j, file.joints.len(), share * v), 3)
            })
        };
        table.push([
            Cell::text(joint.clone()),
            top.map_or_else(Cell::missing, |v| Cell::significant(v, 3)),
            at(1.0),
            at(0.1),
            Cell::text(names(list)),
        ]);
    }
    table
}

/// Names of the effects beyond the basic ones, as text.
fn names(list: &[WeightedTerm]) -> String {
    let mut names: Vec<String> = Vec::new();
    for w in list.iter().filter(|w| !BASIC.contains(&w.term.effect())) {
        let effect = w.term.effect().replace("_friction", "");
        let name = effect.replace("_hysteresis", "").replace('_', " ");
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let more = names.len().saturating_sub(NAMED);
    names.truncate(NAMED);
    if more > 0 {
        names.push(format!("{more} more"));
    }
    names.join(", ")
}

/// Table of every joint's errors: NRMSE of each model over all samples, and of the whole model in motion, with
/// its RMSE over all samples. None without a torque row.
pub fn errors_by_joint(joints: &[String], rows: &[Row]) -> Option<Table> {
    let of = |scope: Scope| {
        rows.iter()
            .filter(move |r| r.scope == scope && !is_forward(r) && !is_yardstick(r))
    };
    let mut models: Vec<&Row> = of(Scope::All).collect();
    models.truncate(MODELS);
    // A variant (`physics [causal]`) stands beside the models and is not the one that counts.
    let best = models
        .iter()
        .rfind(|r| !r.name.contains('['))
        .or(models.last())?;
    let moving = of(Scope::Moving).find(|r| r.name == best.name);
    let mut columns = vec![Column::text("joint")];
    columns.extend(models.iter().map(|r| Column::number(r.name.clone())));
    columns.push(Column::number("in motion"));
    columns.push(Column::number("RMSE / N·m"));
    let mut table = Table::new(columns);
    for (j, joint) in joints.iter().enumerate() {
        let mut cells = vec![Cell::text(joint.clone())];
        cells.extend(models.iter().map(|r| Cell::optional(r.scores.nrmse[j], 4)));
        cells.push(Cell::optional(moving.and_then(|r| r.scores.nrmse[j]), 4));
        cells.push(best.scores.rmse[j].map_or_else(Cell::missing, |v| Cell::significant(v, 3)));
        table.push(cells);
    }
    let mut cells = vec![Cell::text("mean")];
    cells.extend(
        models
            .iter()
            .map(|r| Cell::optional(r.scores.mean_nrmse, 4)),
    );
    cells.push(Cell::optional(moving.and_then(|r| r.scores.mean_nrmse), 4));
    cells.push(Cell::text(""));
    table.push(cells);
    Some(table.emphasise_last())
}
