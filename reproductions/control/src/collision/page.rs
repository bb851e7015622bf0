//! Tables and page of `eval --collision`.

use super::recording::{Collisions, Detector};
use super::regime::Regime;
use report::figure::{Ink, Panel, Plot};
use report::{Cell, Column, Page, Section, Table};

/// Alarms that a table shows.
const SHOWN: usize = 30;

/// Thresholds of every joint, a row for each way of moving; then the alarms, none where there is none.
pub fn tables(collisions: &Collisions) -> (Table, Option<Table>) {
    let mut columns = vec![
        Column::text("joint"),
        Column::number("residual RMS"),
        Column::text("where it is"),
    ];
    columns.extend(
        collisions
            .detectors
            .iter()
            .map(|d| Column::number(format!("threshold, {}", words(d)))),
    );
    let mut thresholds = Table::new(columns);
    for (j, joint) in collisions.joints.iter().enumerate() {
        for (k, regime) in Regime::ALL.into_iter().enumerate() {
            let mut row = match k {
                0 => vec![
                    Cell::text(joint),
                    Cell::significant(collisions.residual_rms[j], 3),
                ],
                _ => vec![Cell::text(""), Cell::text("")],
            };
            row.push(Cell::text(regime.words()));
            let limits = collisions.detectors.iter();
            row.extend(limits.map(|d| Cell::significant(d.thresholds[j].of(regime), 3)));
            thresholds.push(row);
        }
    }
    let mut alarms = Table::new([
        Column::text("detector"),
        Column::text("trajectory"),
        Column::number("time / s"),
        Column::text("joint"),
        Column::number("largest"),
    ]);
    let mut any = false;
    for detector in &collisions.detectors {
        for found in detector.alarms.iter().take(SHOWN) {
            any = true;
            alarms.push([
                Cell::text(words(detector)),
                Cell::text(&found.trajectory),
                Cell::number(found.alarm.time, 3),
                Cell::text(&found.name),
                Cell::significant(found.alarm.value, 3),
            ]);
        }
    }
    (thresholds, any.then_some(alarms))
}

fn words(detector: &Detector) -> String {
    detector.name.replace('_', " ")
}

/// The same with the residuals over time.
pub fn page(collisions: &Collisions) -> Page {
    let (thresholds, alarms) = tables(collisions);
    let mut section = Section::new("Thresholds").paragraph(format!(
        "For {} false alarms per hour of all joints together, from {:.0} s; {:.0} s looked at. TorqueErrorFilter {:.4}. N·m (N for sliding \
         joints). Standing counts until 0.3 s after it.",
        collisions.false_alarms,
        collisions.calibration_seconds,
        collisions.seconds,
        collisions.torque_error_filter
    ));
    section = section.table(thresholds);
    let mut found = Section::new("Alarms");
    found = match alarms {
        Some(table) => found.table(table),
        None => found.paragraph("None."),
    };
    let mut page = Page::new("Collisions").section(section).section(found);
    for detector in &collisions.detectors {
        let signal = &detector.signal;
        let mut section = Section::new(format!("Residual of the {}", words(detector)));
        let mut figures = Vec::new();
        for (j, joint) in collisions.joints.iter().enumerate() {
            let y: Vec<f64> = (0..signal.time.len())
                .map(|row| signal.at(row, j))
                .collect();
            let limit = |sign: f64| -> Vec<f64> {
                let each = 0..signal.time.len();
                each.map(|row| sign * detector.thresholds[j].of(signal.regime(row, j)))
                    .collect()
            };
            let panel = Panel::new("N·m or N")
                .height(140.0)
                .segments(
                    "residual",
                    Ink::Residual,
                    &signal.time,
                    &y,
                    &signal.stretches,
                )
                .segments(
                    "threshold",
                    Ink::Muted,
                    &signal.time,
                    &limit(1.0),
                    &signal.stretches,
                )
                .segments(
                    "threshold",
                    Ink::Muted,
                    &signal.time,
                    &limit(-1.0),
                    &signal.stretches,
                );
            figures.push(
                Plot::new(joint, "time / s")
                    .panel(panel)
                    .half_width()
                    .draw(""),
            );
        }
        section = section.figures(figures);
        page = page.section(section);
    }
    page.section(Section::new("What the figures depend on").list(collisions.notes.clone()))
}
