//! What a person reads.

use model::payload::{Figure, Payload};
use report::{Cell, Column, Table, say, say_text};

/// Width of a line for a person.
const WIDTH: usize = 100;

/// Prints the body and what it leaves.
pub fn print(found: &Payload, source: &str) {
    say!(
        "{source}: {} samples, body on {}\n",
        found.samples,
        found.frame
    );
    let mut table = Table::new([
        Column::text("figure"),
        Column::number("value"),
        Column::text("unit"),
    ]);
    let body = &found.body;
    let figures = [("mass", body.mass, "kg")]
        .into_iter()
        .chain(named(["com x", "com y", "com z"], &body.com, "m"))
        .chain(named(["m·x", "m·y", "m·z"], &body.first_moment, "kg·m"))
        .chain(named(
            ["Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"],
            &body.inertia,
            "kg·m²",
        ));
    for (name, figure, unit) in figures {
        let value = figure.map_or_else(
            || Cell::text("not told"),
            |f: Figure| Cell::with_std(f.value, f.std),
        );
        table = table.row([Cell::text(name), value, Cell::text(unit)]);
    }
    say_text!(table.to_text());
    say!();
    let mut table = Table::new([
        Column::text("joint"),
        Column::number("RMSE without / N·m"),
        Column::number("with / N·m"),
    ]);
    let errors = found.rmse_without.iter().zip(&found.rmse_with);
    for (joint, (without, with)) in found.joints.iter().zip(errors) {
        let cells = [without, with].map(|v| Cell::significant(*v, 3));
        let [without, with] = cells;
        table = table.row([Cell::text(joint), without, with]);
    }
    say_text!(table.to_text());
    say!();
    for note in &found.notes {
        say_text!(report::wrapped(note, WIDTH, ""));
    }
}

fn named<const N: usize>(
    names: [&'static str; N],
    figures: &[Option<Figure>; N],
    unit: &'static str,
) -> impl Iterator<Item = (&'static str, Option<Figure>, &'static str)> {
    let figures = *figures;
    names
        .into_iter()
        .zip(figures)
        .map(move |(name, figure)| (name, figure, unit))
}
