//! Report of a diagnosis as an HTML page.

mod chain;
mod following;

use crate::catalogue::Effect;
use crate::diagnosis::Outcome;
use crate::schema::{REPEATABILITY, Report};
use crate::simulate::Track;
use crate::tracks::Replayed;
use crate::words;
use report::figure::{Ink, Panel, Plot, Waterfall};
use report::{Cell, Column, Figure, KeyFigure, Page, Section, Table, Tone};
use std::path::PathBuf;

/// Length of the piece of motion that is shown, s.
const SHOWN: f64 = 8.0;

/// What a page names beside the diagnosis: what was read, and what is written.
pub struct Files<'a> {
    /// Robot and recordings, each with its part in the diagnosis.
    pub inputs: &'a [(String, String)],
    /// Paths of the corrected model's files, the model first; empty where none are written.
    pub patched: &'a [PathBuf],
    /// What these files change of the simulator as given, a line each.
    pub changes: &'a [String],
    /// What these files do not hold, a line each.
    pub left_out: &'a [String],
}

/// Page of a diagnosis as self-contained HTML text.
pub fn page(outcome: &Outcome, heldout: &Replayed, files: &Files, title: &str) -> String {
    let report = &outcome.report;
    let tone = match report.verdict {
        "no_gap" | "explained" => Tone::Good,
        _ => Tone::Neutral,
    };
    let verdict = KeyFigure::new("verdict", report.verdict.replace('_', " ")).tone(tone);
    let mut page = Page::new(title)
        .subtitle(words::verdict(report))
        .key_figure(verdict);
    for (label, step) in [
        ("as given", report.ladder.first()),
        ("corrected", report.corrected()),
    ] {
        if let Some(part) = step.and_then(|s| s.figures.mean_unexplained) {
            let figure = KeyFigure::new(
                format!("unexplained, {label}"),
                format!("{:.0} %", 100.0 * part),
            );
            page = page.key_figure(figure.note("mean over joints, held out"));
        }
    }
    if let Some(first) = report.causes.iter().find(|c| c.confirmed) {
        let on = format!("on {}", first.joints.join(", "));
        page = page.key_figure(KeyFigure::new("biggest cause", self::title(first.effect)).note(on));
    }
    page.section(Section::new("What to do next").list(words::next(
        report,
        files.patched,
        self::title,
    )))
    .section(causes(report))
    .section(chain::section(outcome, heldout, self::title))
    .section(curves(outcome, heldout))
    .section(following::following(outcome, heldout))
    .section(ladder(report))
    .section(places(report))
    .section(drives(report, files))
    .section(limits(report))
    .section(Section::new("Provenance").pairs(files.inputs.to_vec()))
    .footer(format!(
        "Made by residyn {} (schema {}).",
        env!("CARGO_PKG_VERSION"),
        report.schema
    ))
    .render()
}

/// Words for the effect with this name in the report; empty for other names.
fn title(name: &str) -> &'static str {
    Effect::ALL
        .iter()
        .find(|e| e.name() == name)
        .map_or("", |e| e.words())
}

/// Section with the causes and their values.
fn causes(report: &Report) -> Section {
    let mut section = Section::new("What is missing");
    if report.causes.is_empty() {
        return section.paragraph("No effect is listed: none is more probable than not.");
    }
    section = section.list(
        report
            .causes
            .iter()
            .map(|c| words::cause(c, title(c.effect))),
    );
    let mut table = Table::new([
        Column::text("effect"),
        Column::text("joint"),
        Column::text("value"),
        Column::number("simulator has"),
        Column::number("motion shows"),
        Column::number("± std"),
        Column::text("unit"),
    ]);
    for c in &report.causes {
        for v in &c.parameters {
            table.push([
                Cell::text(title(c.effect)),
                Cell::text(v.joint.clone().unwrap_or_else(|| "whole arm".to_owned())),
                Cell::text(v.name),
                v.given
                    .map_or_else(|| Cell::text("none"), |g| Cell::significant(g, 3)),
                Cell::significant(v.value, 3),
                v.std
                    .map_or_else(Cell::missing, |s| Cell::significant(s, 2)),
                Cell::text(words::unit(v.unit)),
            ]);
        }
    }
    section.table(table)
}

/// Section with the motion of each joint over the seconds with the largest error: commanded, measured, simulated as
/// given and corrected.
fn curves(outcome: &Outcome, heldout: &Replayed) -> Section {
    let section = Section::new("Motion: commanded, measured, simulated");
    let Some((which, rows)) = worst(outcome, heldout) else {
        return section;
    };
    let track = &heldout.whole[which];
    let n = heldout.tracking.len();
    let time: Vec<f64> = track.time[rows.clone()].to_vec();
    let joints = (0..n).filter(|&j| heldout.moves[j]);
    let figures = joints.map(|j| {
        let column = |f: &dyn Fn(usize) -> f64| -> Vec<f64> { rows.clone().map(f).collect() };
        let simulated =
            |k: usize| column(&|r| track.q[(r, j)] + outcome.errors[k][which][r * n + j]);
        let panel = Panel::new("rad (m)")
            .line(
                "command",
                Ink::Series(3),
                &time,
                &column(&|r| track.commands[j].value(track.time[r])),
            )
            .line(
                "measured",
                Ink::Measured,
                &time,
                &column(&|r| track.q[(r, j)]),
            )
            .line("as given", Ink::Muted, &time, &simulated(0))
            .line("corrected", Ink::Predicted, &time, &simulated(1));
        figure(&outcome.report.joints[j], panel)
    });
    let section = section.paragraph(format!(
        "The {SHOWN:.0} seconds in which the simulator as given is furthest off. One uninterrupted roll-out from the recorded start. Drag over a \
         curve to see a part of it, and double-click to see all again."
    ));
    figures.fold(section, Section::figure)
}

/// Figure with the curves of one joint.
fn figure(joint: &str, panel: Panel) -> Figure {
    Plot::new(joint, "time / s")
        .zoomable()
        .panel(panel)
        .draw(format!(
            "{joint}: the corrected curve should lie on the measured one"
        ))
}

/// Index of the trajectory, and rows, with the largest squared error of the simulator as given. Each joint's error is
/// taken relative to its tracking error.
fn worst(outcome: &Outcome, heldout: &Replayed) -> Option<(usize, std::ops::Range<usize>)> {
    let n = heldout.tracking.len();
    let mut best: Option<(f64, usize, std::ops::Range<usize>)> = None;
    for (k, track) in heldout.whole.iter().enumerate() {
        for part in windows(track) {
            let sum: f64 = part
                .clone()
                .flat_map(|r| (0..n).map(move |j| (r, j)))
                .filter(|(_, j)| heldout.moves[*j] && heldout.tracking[*j] > 0.0)
                .map(|(r, j)| (outcome.errors[0][k][r * n + j] / heldout.tracking[j]).powi(2))
                .sum();
            if best.as_ref().is_none_or(|b| sum > b.0) {
                best = Some((sum, k, part));
            }
        }
    }
    best.map(|(_, k, part)| (k, part))
}

/// Successive ranges of rows, each of the length that is shown.
fn windows(track: &Track) -> Vec<std::ops::Range<usize>> {
    let mut out = Vec::new();
    let mut from = 0;
    for row in 1..track.time.len() {
        let last = row + 1 == track.time.len();
        if track.time[row] - track.time[from] >= SHOWN || last {
            out.push(from..row + 1);
            from = row;
        }
    }
    out
}

/// Section with the error after each step of the ladder.
fn ladder(report: &Report) -> Section {
    let mut waterfall = Waterfall::new("How far the gap shrinks", "unexplained").decimals(3);
    let mut columns = vec![Column::text("step"), Column::number("mean")];
    columns.extend(report.joints.iter().map(|j| Column::number(j.clone())));
    let mut table = Table::new(columns);
    for step in &report.ladder {
        let name = match title(&step.step) {
            "" => step.step.replace('_', " "),
            words => words.to_owned(),
        };
        if let Some(mean) = step.figures.mean_unexplained {
            waterfall = if step.step == REPEATABILITY {
                waterfall.floor(name.clone(), mean)
            } else {
                waterfall.step(name.clone(), mean)
            };
        }
        let mut row = vec![
            Cell::text(name),
            Cell::optional(step.figures.mean_unexplained, 3),
        ];
        row.extend(
            step.figures
                .unexplained
                .iter()
                .map(|u| Cell::optional(*u, 3)),
        );
        table.push(row);
    }
    let section = Section::new("Step by step")
        .paragraph("Unexplained is RMS(simulated − measured) over RMS(command − measured): 1 knows nothing of how the robot departs from its commands, 0 is perfect.")
        .figure(waterfall.draw("Unexplained part on the held-out recording, mean over joints"))
        .table(table)
        .paragraph(file_alone(report));
    let ceiling = report.ceiling.as_ref().and_then(words::ceiling);
    ceiling.into_iter().fold(section, Section::paragraph)
}

/// Sentence on the error that the model file alone leaves.
fn file_alone(report: &Report) -> String {
    let part = report.file_alone.figures.mean_unexplained.unwrap_or(0.0);
    format!(
        "A model file holds no coupling and no friction by load or at standstill. Written for itself, it leaves {:.1} %.",
        100.0 * part
    )
}

/// Section with the regions in which the error is concentrated.
fn places(report: &Report) -> Section {
    let mut table = Table::new([
        Column::text("joint"),
        Column::text("where"),
        Column::number("from"),
        Column::number("to"),
        Column::text("unit"),
        Column::number("share of the gap"),
        Column::number("share of the time"),
    ]);
    for p in &report.places {
        table.push([
            Cell::text(p.joint.clone()),
            Cell::text(p.coordinate.replace('_', " ")),
            Cell::significant(p.range[0], 3),
            Cell::significant(p.range[1], 3),
            Cell::text(words::unit(p.unit)),
            Cell::number(p.share_of_gap, 2),
            Cell::number(p.share_of_time, 2),
        ]);
    }
    Section::new("Where the gap lies").table(table)
}

/// Section with the drives and joints of the corrected simulator, and the paths `patched` of its files.
fn drives(report: &Report, files: &Files) -> Section {
    let mut table = Table::new([
        Column::text("joint"),
        Column::number("kp"),
        Column::number("kd"),
        Column::number("delay / ms"),
        Column::number("damping"),
        Column::number("frictionloss"),
        Column::number("armature"),
    ]);
    for (j, name) in report.joints.iter().enumerate() {
        let (c, p) = (&report.controller, &report.joint_parameters);
        table.push([
            Cell::text(name.clone()),
            Cell::significant(c.kp[j], 3),
            Cell::significant(c.kd[j], 3),
            Cell::number(1e3 * c.delay[j], 1),
            Cell::significant(p.damping[j], 3),
            Cell::significant(p.frictionloss[j], 3),
            Cell::significant(p.armature[j], 3),
        ]);
    }
    let note = "What a model file cannot hold, such as friction by torque, is part of this simulator. The file is fitted without it, \
                so that some of its values differ.";
    let section = Section::new("The corrected simulator")
        .paragraph(note)
        .table(table);
    let Some(written) = report::write::together(files.patched) else {
        return section;
    };
    let mut section = section.paragraph(format!("The corrected model is {written}."));
    for (what, lines) in [
        ("It changes of the simulator as given:", files.changes),
        ("It does not hold:", files.left_out),
    ] {
        if !lines.is_empty() {
            section = section.paragraph(what).list(lines.to_vec());
        }
    }
    section
}

/// Section with the quantities that the motion does not determine, and the notes.
fn limits(report: &Report) -> Section {
    let section = Section::new("What this motion cannot show");
    let open = words::not_known(&report.not_identifiable);
    let section = if open.is_empty() {
        section.paragraph("Nothing that was fitted is left open.")
    } else {
        section.list(open)
    };
    if report.notes.is_empty() {
        section
    } else {
        section.details(Section::new("Notes").list(report.notes.clone()))
    }
}
