//! The HTML page of `eval` (and of `train`'s held-out recording), and the arm on the pages of `diagnose` and `replay`.

mod arm;
mod identification;
mod residuals;
mod subject;

pub use arm::arm;
pub use subject::Subject;

use crate::directory::ModelFile;
use crate::tables;
use datasets::metrics::Scope;
use report::figure::{Ink, Panel, Plot};
use report::{KeyFigure, Page, Section, Tone};

/// Page of a model: scores, measured against predicted torque, residuals, parameters, provenance.
pub fn page(file: &ModelFile, subject: &Subject) -> Page {
    let mut page = Page::new(format!("Torque model of {}", file.physics.robot)).subtitle(format!(
        "{} · {} samples, {} trajectories",
        subject.recording.source,
        subject.recording.len(),
        subject.recording.trajectories.len()
    ));
    for row in subject.rows.iter().filter(|r| r.scope == Scope::All) {
        let value = row
            .scores
            .mean_nrmse
            .map_or_else(|| "–".into(), |v| format!("{v:.4}"));
        page = page.key_figure(
            KeyFigure::new(format!("{}, mean NRMSE", row.name), value).note("all samples"),
        );
    }
    if !subject.rows.is_empty() {
        page = page.section(scores(file, subject));
    }
    page = page.section(Section::new("How to read the figures").list(subject.notes.to_vec()));
    page = page.section(torque(file, subject));
    if subject.recording.tau.is_some() {
        page = page.section(residuals::section(file, subject));
    }
    page = page.section(compensator(file));
    page = page.section(identification::section(file));
    page.section(
        Section::new("Provenance").pairs(
            file.provenance
                .recordings
                .iter()
                .map(|r| {
                    (
                        r.name.clone(),
                        format!(
                            "{} samples, {} trajectories, SHA-256 {}",
                            r.samples,
                            r.trajectories,
                            if r.sha256.is_empty() {
                                "– (simulated)"
                            } else {
                                &r.sha256
                            }
                        ),
                    )
                })
                .chain([("seed".to_owned(), file.provenance.seed.to_string())]),
        ),
    )
    .footer(format!("residyn {}", env!("CARGO_PKG_VERSION")))
}

fn scores(file: &ModelFile, subject: &Subject) -> Section {
    let (joints, rows, published) = (&file.joints, subject.rows, subject.published);
    let mut section = Section::new("Scores")
        .paragraph("NRMSE is the root mean squared error over the standard deviation of the measured torque over all samples; R² = 100·(1 − NRMSE²) percent. “moving” keeps, for each joint, the samples with |q̇| above 0.01 rad/s (m/s). “linear_baseline” is the KR300 benchmark's: each torque linear in positions, velocities and accelerations of all joints, without physics. Away from the motion that it was fitted to it is far off.")
        .table(tables::scores(joints, rows, published).caption("NRMSE of torque per joint"))
        .table(tables::errors(joints, rows).caption("Root mean squared error of torque"));
    if let Some(table) = tables::forward(joints, rows, published) {
        section = section.table(table.caption(
            "The other way round: NRMSE of positions that a linear state space simulates from the recorded torque",
        ));
    }
    if !published.is_empty() {
        section = section.list(tables::sources(published));
    }
    section
}

fn torque(file: &ModelFile, subject: &Subject) -> Section {
    let time = &subject.recording.time;
    let rows: Vec<_> = subject
        .recording
        .trajectories
        .iter()
        .map(|t| t.range.clone())
        .collect();
    let figures = file.joints.iter().enumerate().map(|(j, name)| {
        let predicted = subject.torque.column(j).to_vec();
        let mut upper = Panel::new("torque / N·m");
        let mut plot = Plot::new(name.clone(), "time / s").zoomable();
        if let Some(tau) = &subject.recording.tau {
            let measured = tau.column(j).to_vec();
            let residual: Vec<f64> = measured
                .iter()
                .zip(&predicted)
                .map(|(m, p)| m - p)
                .collect();
            upper = upper
                .segments("measured", Ink::Measured, time, &measured, &rows)
                .segments("predicted", Ink::Predicted, time, &predicted, &rows);
            plot = plot
                .panel(upper)
                .panel(Panel::new("residual / N·m").height(110.0).segments(
                    "residual",
                    Ink::Residual,
                    time,
                    &residual,
                    &rows,
                ));
        } else {
            plot = plot.panel(upper.segments("predicted", Ink::Predicted, time, &predicted, &rows));
        }
        plot.draw(format!("{name}: measured and predicted torque over time"))
    });
    let section = Section::new("Torque over time").paragraph(
        "Drag over a curve to see a part of it, with Shift to move along, and double-click to see all again; the joints move together.",
    );
    figures.fold(section, Section::figure)
}

fn compensator(file: &ModelFile) -> Section {
    let section = Section::new("Compensator");
    let Some(record) = &file.compensator else {
        return section.paragraph("This model has no learned part.");
    };
    let lines = record.validation.iter().map(|v| {
        let figure = |x: Option<f64>| x.map_or_else(|| "–".to_owned(), |x| format!("{x:.4} N·m"));
        let others = v.sees();
        let others = others.map_or(String::new(), |o| format!(", also sees {o}"));
        let state = if v.enabled { "on" } else { "off, it did not help" };
        if v.with_unit.is_none() {
            return format!("{}: {state}{others}; not tried, for the training has one trajectory", v.joint);
        }
        format!(
            "{}: {state}{others}; error on trajectories held back: physics {}, with the unit {}, with ridge regression on the same inputs {}",
            v.joint, figure(v.physics), figure(v.with_unit), figure(v.with_ridge)
        )
    });
    section
        .callout(Tone::Neutral, "Bounded", "Away from its training inputs the learned torque fades to zero, and it never exceeds what training saw.")
        .list(lines.collect::<Vec<_>>())
}
