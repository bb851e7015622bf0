//! Output and scores of `--yardsticks`.

use datasets::Recording;
use datasets::metrics::{Row, Scope};
use model::failure::Failure;
use model::physics_fit::Fit;
use model::residual::{Compared, HeldBack};
use model::tables::{RIDGE, TREES};
use report::{Cell, Column, Table, say, say_text};

/// Rows of physics with each yardstick on the held-out recording, part `part` of the session.
pub fn rows(
    fit: &Fit,
    compared: &Compared,
    part: usize,
    recording: &Recording,
) -> Result<Vec<Row>, Failure> {
    let Some(tau) = &recording.tau else {
        return Ok(Vec::new());
    };
    let qd = &fit.session.parts[part].at_samples.qd;
    let mut rows = Vec::new();
    for (name, residual) in [RIDGE, TREES].iter().zip(&compared.torque[part]) {
        let torque = &fit.physics[part] + residual;
        let both = Row::both_scopes(name, tau, &torque, qd);
        rows.extend(both.map_err(|e| Failure::other(e.to_string()))?);
    }
    Ok(rows)
}

/// Prints how they fared on the folds held back and, where one was scored, on the held-out recording.
pub fn print(compared: &Compared, heldout: Option<&[Row]>) {
    say!(
        "\nYardsticks on the same inputs: RMS error in N·m on folds held back from training (the last\n\
         epoch is not chosen on these folds, `unit` is; ridge and trees were chosen on other folds)\n"
    );
    say_text!(table(&compared.yardsticks.held_back).to_text());
    for name in [RIDGE, TREES] {
        let figure = |scope| {
            let row = heldout?
                .iter()
                .find(|r| r.name == name && r.scope == scope)?;
            row.scores.mean_nrmse
        };
        let [all, moving] = Scope::BOTH.map(figure);
        if let Some(all) = all {
            let moving = moving.map_or_else(|| "–".to_owned(), |v| format!("{v:.4}"));
            say!("{name} on the held-out recording: mean NRMSE {all:.4}, in motion {moving}");
        }
    }
}

fn table(joints: &[HeldBack]) -> Table {
    let mut table = Table::new([
        Column::text("joint"),
        Column::number("physics"),
        Column::number("unit"),
        Column::number("last epoch"),
        Column::number("ridge"),
        Column::number("trees"),
        Column::number("grown"),
    ]);
    let cell = |v: Option<f64>| v.map_or_else(Cell::missing, |v| Cell::significant(v, 4));
    for joint in joints {
        let figures = [
            joint.physics,
            joint.unit,
            joint.unit_at_last_epoch,
            joint.ridge,
            joint.trees,
        ];
        let cells = std::iter::once(Cell::text(joint.joint.clone()))
            .chain(figures.map(cell))
            .chain([Cell::text(joint.tree_count.to_string())]);
        table.push(cells.collect::<Vec<_>>());
    }
    table
}
