//! Sections on the causes with their evidence, and on the numbers to set.

use crate::advice::patch::{ForMujoco, Patch};
use crate::catalogue::Parameter;
use crate::outcome::Outcome;
use crate::report::words::{corrected, name, told};
use crate::schema::{Cause, Diagnosis};
use report::figure::{Bars, Ink};
use report::{Cell, Column, Section, Table};
use std::path::PathBuf;

/// Number of candidates listed beside the causes.
const TRIED: usize = 12;

/// Section of the page with the causes and their evidence.
pub(super) fn section(outcome: &Outcome) -> Section {
    let d = &outcome.diagnosis;
    if d.causes.is_empty() {
        let none = "None is listed: no effect of the catalogue explains anything beyond noise and small changes of parameters.";
        return Section::new("Causes").paragraph(none).details(tried(d));
    }
    let title = |c: &Cause, most: usize| {
        let on = match c.joints.len() {
            n if n == d.joints.len() => "all joints".to_owned(),
            n if n > most => format!("{n} joints"),
            _ => c.joints.join(", "),
        };
        let driver = c
            .driver
            .as_ref()
            .map_or(String::new(), |x| format!(" ← {x}"));
        format!("{} · {on}{driver}", name(c.effect))
    };
    // Beside a bar there is room for the name of one joint.
    let short = |c: &Cause| title(c, 1);
    let shares = Bars::new(
        "Share of the gap by cause",
        "share",
        d.causes.iter().map(short),
    )
    .series(
        "share of what all causes remove",
        Ink::Series(0),
        &d.causes
            .iter()
            .map(|c| Some(c.share_of_gap))
            .collect::<Vec<_>>(),
    );
    let closed = Bars::new(
        "Part of its joints' error that each cause removes",
        "part closed",
        d.causes.iter().map(short),
    )
    .series_with_intervals(
        "with 90 % interval",
        Ink::Predicted,
        &d.causes
            .iter()
            .map(|c| {
                let point = [c.gap_closed, c.gap_closed];
                (c.gap_closed, c.gap_closed_interval.unwrap_or(point))
            })
            .collect::<Vec<_>>(),
    );
    // A column that nothing fills says nothing.
    let sure = d.causes.iter().any(|c| c.confidence.is_some());
    let head = [
        Column::text("cause"),
        Column::text("joints"),
        Column::number("lead over other names / nats"),
    ];
    let head = head
        .into_iter()
        .chain(sure.then(|| Column::number("probability that the name is right")))
        .chain([
            Column::number("chance of such a gain"),
            Column::text("shown by the held-out recording"),
            Column::text("could also be"),
        ]);
    let table = d.causes.iter().fold(Table::new(head), |t, c| {
        let rivals: Vec<String> = c.ambiguous_with.iter().map(|e| name(*e)).collect();
        let first = [
            Cell::text(name(c.effect)),
            Cell::text(c.joints.join(", ")),
            Cell::optional(c.lead, 0),
        ];
        let cells = first
            .into_iter()
            .chain(sure.then(|| Cell::optional(c.confidence, 2)));
        t.row(cells.chain([
            Cell::optional(c.p_value, 3),
            Cell::text(match (c.confirmed, c.remark) {
                (true, None) => "yes".to_owned(),
                (true, Some(remark)) => format!("yes ({remark})"),
                (false, None) => "no".to_owned(),
                (false, Some(remark)) => format!("no ({remark})"),
            }),
            if rivals.is_empty() {
                Cell::missing()
            } else {
                Cell::text(rivals.join(", "))
            },
        ]))
    });
    let mut section = Section::new("Causes")
        .figure(shares.draw(
            "Shapley's value in squared NRMSE, or what is lost without the cause if that is more, as parts of their sum.",
        ))
        .figure(closed.draw(
            "The other causes being in place; intervals by bootstrap over stretches of time.",
        ))
        .table(table)
        .heading("Sizes");
    let sizes = d.causes.iter().filter(|c| !c.parameters.is_empty());
    for cause in sizes {
        section = section
            .details(Section::new(title(cause, usize::MAX)).table(parameters(&cause.parameters)));
    }
    section.details(tried(d))
}

fn parameters(list: &[Parameter]) -> Table {
    let head = [
        Column::text("parameter"),
        Column::text("joint"),
        Column::number("value"),
        Column::text("unit"),
    ];
    list.iter().fold(Table::new(head), |t, p| {
        t.row([
            Cell::text(p.name.replace('_', " ")),
            p.joint.as_ref().map_or_else(Cell::missing, Cell::text),
            Cell::with_std(p.value, p.std.unwrap_or(0.0)),
            Cell::text(p.unit.text()),
        ])
    })
}

/// Table of the other candidates, with the causes in place or left out in turn.
fn tried(d: &Diagnosis) -> Section {
    let head = [
        Column::text("effect"),
        Column::text("joints"),
        Column::number("part closed on trajectories left out"),
    ];
    let table = d
        .candidates
        .iter()
        .take(TRIED)
        .fold(Table::new(head), |t, c| {
            t.row([
                Cell::text(name(c.effect)),
                Cell::text(c.joints.join(", ")),
                Cell::number(c.gap_closed, 3),
            ])
        });
    Section::new("Evidence: what was tried in their place").table(table)
}

/// Section with the numbers to set in common simulators. `patched` are the paths of the patch's files.
pub(super) fn simulators(d: &Diagnosis, patch: &Patch, patched: &[PathBuf]) -> Section {
    let head = [
        Column::text("joint"),
        Column::text("set"),
        Column::number("given"),
        Column::number("to"),
        Column::text("unit"),
        Column::text("MuJoCo joint"),
        Column::text("Isaac"),
        Column::text("Gazebo (SDF)"),
    ];
    let table = patch
        .settings
        .iter()
        .filter(|s| s.given != 0.0 || s.value != 0.0)
        .fold(Table::new(head), |t, s| {
            t.row([
                Cell::text(&s.joint),
                Cell::text(s.what),
                Cell::significant(s.given, 4),
                Cell::significant(s.value, 4),
                Cell::text(s.unit),
                Cell::text(s.mujoco),
                Cell::text(s.isaac),
                if s.gazebo.is_empty() {
                    Cell::missing()
                } else {
                    Cell::text(s.gazebo)
                },
            ])
        });
    let mut section = Section::new(format!("What to set in the {}", corrected(d)));
    if d.causes.is_empty() {
        section =
            section.paragraph("Nothing has to change; the values below fit the recording best.");
    }
    let section = section
        .list(
            d.causes
                .iter()
                .map(|c| format!("{}: {}.", name(c.effect), told(c))),
        )
        .table(table.caption("Friction and rotor inertia with all causes in place"));
    let (section, files) = match &patch.mjcf {
        ForMujoco::Whole(_) => (
            section,
            "--patch writes these values into the whole model, and a table beside it.",
        ),
        ForMujoco::Snippet(text) => (
            section.details(Section::new("MuJoCo: elements to merge by name").code(text)),
            "--patch writes these values: a URDF, the MuJoCo elements, a table, and a drive file for rotor inertias.",
        ),
    };
    let written = report::write::together(patched);
    section.paragraph(written.map_or(files.to_owned(), |w| format!("These values stand in {w}.")))
}
