//! Overview tables: each joint's friction, and its errors beside the baseline's.

use super::{is_forward, is_yardstick};
use crate::directory::ModelFile;
use datasets::metrics::{REST, Row, Scope};
use physics::effects::{Sample, TermBank};
use physics::torque_model::WeightedTerm;
use report::{Cell, Column, Table};
use signal::Motion;
use signal::quantile::quantile;

/// Largest number of effects that are named per joint.
const NAMED: usize = 2;
/// Largest number of models beside each other in the table.
const MODELS: usize = 5;
/// Quantile of a joint's speeds that is taken as its top speed.
const TOP: f64 = 0.99;
/// Simulation of steady motion: time until friction memory has settled, time over which torque is then averaged, and step, s.
const STEADY: [f64; 3] = [2.0, 2.0, 0.002];
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
        let speeds = motions.iter().flat_map(|m| m.qd.column(j)).map(|v| v.abs());
        let top = quantile(speeds.collect(), TOP).filter(|v| *v > REST);
        let at = |share: f64| {
            top.map_or_else(Cell::missing, |v| {
                Cell::significant(steady(list, j, file.joints.len(), share * v), 3)
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

/// Half the difference of a joint's torque in steady motion forwards and backwards at `speed`, N·m (N).
fn steady(list: &[WeightedTerm], joint: usize, joints: usize, speed: f64) -> f64 {
    let [settle, average, dt] = STEADY;
    let (rows, from) = (((settle + average) / dt) as usize, (settle / dt) as usize);
    let zeros = vec![0.0; joints];
    let torque = |direction: f64| {
        let mut bank = TermBank::new(joint, list.iter().map(|w| w.term.clone()).collect());
        let (mut q, mut qd) = (zeros.clone(), zeros.clone());
        let mut values = vec![0.0; list.len()];
        qd[joint] = direction * speed;
        let mut sum = 0.0;
        for row in 0..rows {
            q[joint] = direction * speed * dt * row as f64;
            let sample = Sample {
                clock: None,
                dt: if row == 0 { 0.0 } else { dt },
                q: &q,
                qd: &qd,
                qdd: &zeros,
                load: &zeros,
            };
            bank.step(&sample, &mut values);
            if row >= from {
                let friction = list.iter().zip(&values);
                sum += friction
                    .filter(|(w, _)| w.term.passive().is_none())
                    .map(|(w, v)| w.value * v)
                    .sum::<f64>();
            }
        }
        sum / (rows - from) as f64
    };
    0.5 * (torque(1.0) - torque(-1.0))
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
