//! Output for the user.

use model::payload::gains::DriveGains;
use model::payload::{Figure, Payload};
use report::{Cell, Column, Table, say, say_text};

/// Width of a line for a person.
const WIDTH: usize = 100;

/// Prints the body and the residual beside it.
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
    say_notes(&found.notes);
}

/// Prints the gains of all joints; `sources`: recordings without and with the body.
pub fn print_gains(found: &DriveGains, sources: [&str; 2]) {
    let [without, with] = found.samples;
    let [free, carrying] = sources;
    say!("{free}: {without} samples without, {carrying}: {with} samples with the known body\n");
    let mut table = Table::new([
        Column::text("joint"),
        Column::number("gain"),
        Column::number("possible links"),
        Column::number("ordinary least squares"),
        Column::number("left / N·m"),
    ]);
    let cell = |value: Option<f64>, digits: usize| {
        value.map_or_else(|| Cell::text("–"), |v| Cell::significant(v, digits))
    };
    for (j, joint) in found.joints.iter().enumerate() {
        let gain = found.gain[j].map_or_else(
            || Cell::text("not told"),
            |f: Figure| Cell::with_std(f.value, f.std),
        );
        table = table.row([
            Cell::text(joint),
            gain,
            cell(found.possible[j], 4),
            cell(found.ordinary[j], 4),
            cell(found.rmse[j], 3),
        ]);
    }
    say_text!(table.to_text());
    say_notes(&found.notes);
}

fn say_notes(notes: &[String]) {
    say!();
    for note in notes {
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
