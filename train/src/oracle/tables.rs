//! Output of `train oracle`.

use super::figures::{Figures, Scale};
use datasets::metrics::Scores;
use report::{Cell, Column, Table, say, say_text};

/// Prints all tables of `train oracle`.
pub fn print(figures: &Figures) {
    let cutoff = figures.cutoff_hz.map_or_else(
        || "the model's own cut-off".to_owned(),
        |hz| format!("a cut-off of {hz} Hz"),
    );
    say!(
        "Held-out recording of the simulated robot. Attainable: true equations on the motion at {cutoff}."
    );
    for scale in &figures.scopes {
        say!("\nNRMSE, {} samples", scale.scope.name());
        say_text!(scores(figures, scale).to_text());
    }
    say!(
        "\nMechanisms beyond viscous and Coulomb friction, N·m RMS: what each adds; what is left of it when the joint's\n\
         physics is fitted to it; and when the inputs of its unit at that sample are fitted too (linear in both)"
    );
    let joints = figures.joints.iter().map(|j| Column::number(j.clone()));
    let mut table = Table::new(
        [Column::text("mechanism"), Column::text("")]
            .into_iter()
            .chain(joints),
    );
    for left in &figures.mechanisms {
        let row = |name: &str, what: &str, figures: Vec<Option<f64>>| {
            [Cell::text(name), Cell::text(what)]
                .into_iter()
                .chain(figures.into_iter().map(|v| Cell::optional(v, 3)))
                .collect::<Vec<_>>()
        };
        let some = |figures: &[f64]| figures.iter().copied().map(Some).collect();
        table.push(row(left.effect.name(), "adds", some(&left.size)));
        table.push(row("", "left by physics", some(&left.by_physics)));
        if left.by_inputs.iter().any(Option::is_some) {
            table.push(row("", "left with inputs", left.by_inputs.clone()));
        }
    }
    say_text!(table.to_text());
}

fn scores(figures: &Figures, scale: &Scale) -> Table {
    let joints = figures.joints.iter().map(|j| Column::number(j.clone()));
    let mut table = Table::new(
        std::iter::once(Column::text(""))
            .chain(joints)
            .chain([Column::number("all")]),
    );
    let row = |name: &str, of: &[Option<f64>], all: Option<f64>| {
        std::iter::once(Cell::text(name))
            .chain(of.iter().chain([&all]).map(|v| Cell::optional(*v, 4)))
            .collect::<Vec<_>>()
    };
    let mut push = |name, s: &Scores| table.push(row(name, &s.nrmse, s.mean_nrmse));
    push("floor", &scale.floor);
    push("attainable", &scale.attainable);
    push("physics", &scale.physics);
    if let Some(whole) = &scale.whole {
        push("physics+compensator", whole);
    }
    if let Some(share) = &scale.share {
        table.push(row("share removed", &share.joints, share.all));
    }
    table
}
