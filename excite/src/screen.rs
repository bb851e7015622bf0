//! Output for the user.

use crate::judged::Coverage;
use crate::plan::{Plan, Shown};
use crate::summary::Summary;
use diagnose::Unit;
use identify::least_squares::SubRegressors;
use report::{Cell, Column, Table, say, say_text};
use std::path::Path;

/// Width of a line of output, characters.
const WIDTH: usize = 100;

/// Warning that collisions are not checked.
pub const COLLISIONS: &str = "Collisions are not checked, neither with the robot itself nor with anything around it: look at the motion, and run it slowly, before it is run.";

/// Prints a summary; `out` is where the motion was written.
pub fn say(summary: &Summary, out: Option<&Path>) {
    say!("{}", headline(summary));
    say!();
    say_text!(coverage(&summary.joints).to_text());
    say!();
    say_text!(conditions(summary).to_text());
    for line in costs(summary) {
        say!("{line}");
    }
    if let Some(plan) = &summary.plan {
        say!(
            "\nBase parameters, under torque noise of {} N·m a sample:\n",
            noise(summary)
        );
        say_text!(parameters(plan).to_text());
        say!("\nEffects of the diagnosis, and the size from which each would be accepted:\n");
        say_text!(effects(plan, summary.joints.len()).to_text());
        for n in &plan.not_judged {
            say_text!(report::wrapped(
                &format!("{}: {}.", n.effect, n.reason),
                WIDTH,
                ""
            ));
        }
    }
    say!();
    for note in &summary.notes {
        say_text!(report::wrapped(&format!("Note: {note}."), WIDTH, ""));
    }
    say_text!(report::wrapped(COLLISIONS, WIDTH, ""));
    if let Some(out) = out {
        say!("Motion: {}", out.display());
    }
}

/// Sentence on the whole design: robot, trajectories, duration, method.
pub fn headline(summary: &Summary) -> String {
    let count = summary.trajectories.len();
    let seconds: f64 = summary.trajectories.iter().map(|t| t.seconds).sum();
    let runs = if count == 1 {
        "trajectory"
    } else {
        "trajectories"
    };
    let how = match (summary.method, summary.criterion) {
        (Some(method), Some(criterion)) => format!(
            ", {method}, {criterion}, {} motions judged",
            summary.evaluations
        ),
        (Some(method), None) => format!(", {method}"),
        _ => String::new(),
    };
    format!("{}: {count} {runs}, {seconds:.1} s{how}", summary.robot)
}

/// Noise of the joints, N·m.
fn noise(summary: &Summary) -> String {
    let each: Vec<String> = summary.noise.iter().map(|s| format!("{s:.2}")).collect();
    each.join(", ")
}

/// Table of each joint's coverage of its limits.
pub fn coverage(joints: &[Coverage]) -> Table {
    let percent = |[used, limit]: [f64; 2]| Cell::number(100.0 * used / limit, 0);
    let mut table = Table::new([
        Column::text("joint"),
        Column::number("from"),
        Column::number("to"),
        Column::number("range / %"),
        Column::number("speed / %"),
        Column::number("acceleration / %"),
        Column::number("jerk / %"),
        Column::number("torque / %"),
    ]);
    for c in joints {
        table.push([
            Cell::text(&c.joint),
            Cell::number(c.position[0], 2),
            Cell::number(c.position[1], 2),
            Cell::number(100.0 * c.range(), 0),
            percent(c.velocity),
            percent(c.acceleration),
            percent(c.jerk),
            Cell::optional(c.effort().map(|e| 100.0 * e), 0),
        ]);
    }
    table
}

/// Table of the condition numbers.
pub fn conditions(summary: &Summary) -> Table {
    let mut table = Table::new([
        Column::text(format!("{} base parameters", summary.conditions.parameters)),
        Column::number("all"),
        Column::number("inertia"),
        Column::number("gravity"),
        Column::number("friction"),
        Column::number("10 all + 5 + 1 + 1"),
    ]);
    let mut row = |name: &str, c: &SubRegressors| {
        let part = |x: Option<f64>| x.map_or_else(Cell::missing, |v| Cell::significant(v, 3));
        table.push([
            Cell::text(name),
            Cell::significant(c.whole, 3),
            part(c.inertial),
            part(c.gravity),
            part(c.friction),
            Cell::significant(c.criterion(), 3),
        ]);
    };
    row("cond(Y)", &summary.conditions.plain);
    row("cond(Y*), rows over noise", &summary.conditions.weighted);
    table
}

/// Lines on the fall of the criterion.
fn costs(summary: &Summary) -> Vec<String> {
    let Some(first) = summary.trajectories.first() else {
        return Vec::new();
    };
    let (Some(start), Some(criterion)) = (first.start_cost, summary.criterion) else {
        return Vec::new();
    };
    let fell: Vec<String> = summary
        .trajectories
        .iter()
        .filter_map(|t| Some(format!("{:.4}", t.cost?)))
        .collect();
    vec![format!(
        "\n{criterion}: {start:.4} at random, then {}",
        fell.join(", ")
    )]
}

/// Table of all base parameters of a plan.
pub fn parameters(plan: &Plan) -> Table {
    let mut table = Table::new([
        Column::text("parameter"),
        Column::number("in the model"),
        Column::number("deviation"),
        Column::number("relative / %"),
        Column::number("shows from"),
        Column::text("shows"),
    ]);
    let some = |x: Option<f64>| x.map_or_else(Cell::missing, |v| Cell::significant(v, 3));
    for p in &plan.parameters {
        table.push([
            Cell::text(&p.name),
            Cell::significant(p.value, 3),
            some(p.std),
            some(p.relative_percent),
            some(p.shows_from),
            Cell::text(if p.shows { "yes" } else { "" }),
        ]);
    }
    table
}

/// Effects by joint; of a coupling the driver that shows first.
pub fn effects(plan: &Plan, joints: usize) -> Table {
    let mut columns = vec![Column::text("effect"), Column::text("size")];
    columns.extend((1..=joints).map(|j| Column::number(format!("{j}"))));
    columns.push(Column::number("arm"));
    let mut table = Table::new(columns);
    let mut rows: Vec<(&Shown, Vec<Option<f64>>)> = Vec::new();
    for e in &plan.effects {
        let place = if e.places.len() == 1 {
            e.places[0]
        } else {
            joints
        };
        let known = rows
            .iter()
            .position(|(o, _)| o.effect == e.effect && o.unit == e.unit);
        let row = known.unwrap_or_else(|| {
            rows.push((e, vec![None; joints + 1]));
            rows.len() - 1
        });
        let cell = &mut rows[row].1[place];
        if let Some(from) = e.from {
            *cell = Some(cell.map_or(from, |c: f64| c.min(from)));
        }
    }
    for (e, sizes) in rows {
        let unit = if e.unit == Unit::One {
            ""
        } else {
            e.unit.text()
        };
        let mut cells = vec![
            Cell::text(e.effect),
            Cell::text(format!("{} {unit}", e.quantity).trim()),
        ];
        cells.extend(
            sizes
                .into_iter()
                .map(|s| s.map_or_else(Cell::missing, |v| Cell::significant(v, 2))),
        );
        table.push(cells);
    }
    table
}
