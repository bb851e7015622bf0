//! The HTML page of `eval` (and of `train`'s held-out recording).

use crate::directory::ModelFile;
use crate::evaluation::Evaluation;
use crate::metrics::Scope;
use crate::tables;
use report::figure::{Ink, Panel, Plot};
use report::{KeyFigure, Page, Section, Tone};

/// The page: scores, measured against predicted torque, residuals, parameters, provenance.
pub fn page(file: &ModelFile, evaluation: &Evaluation) -> Page {
    let report = &evaluation.report;
    let mut page = Page::new(format!("Torque model of {}", file.physics.robot)).subtitle(format!(
        "{} · {} samples, {} trajectories",
        evaluation.recording.source,
        report.samples,
        evaluation.recording.trajectories.len()
    ));
    for row in report.rows.iter().filter(|r| r.scope == Scope::All) {
        let value = row
            .scores
            .mean_nrmse
            .map_or_else(|| "–".into(), |v| format!("{v:.4}"));
        page = page.key_figure(
            KeyFigure::new(format!("{}, mean NRMSE", row.name), value).note("all samples"),
        );
    }
    let published = evaluation.published(file);
    if !report.rows.is_empty() {
        let mut section = Section::new("Scores")
            .paragraph("NRMSE is the root mean squared error over the standard deviation of the measured torque over all samples; R² = 100·(1 − NRMSE²) percent. “moving” keeps, for each joint, the samples with |q̇| above 0.01 rad/s (m/s).")
            .table(tables::scores(&file.joints, &report.rows, &published).caption("NRMSE per joint"))
            .table(tables::errors(&file.joints, &report.rows).caption("Root mean squared error"));
        if !published.is_empty() {
            section = section.list(published.iter().map(|p| {
                if p.protocol.is_empty() {
                    format!("{}: {}", p.model, p.source)
                } else {
                    format!("{}: {} ({})", p.model, p.source, p.protocol)
                }
            }));
        }
        page = page.section(section);
    }
    page = page.section(Section::new("How to read the figures").list(report.notes.clone()));
    page = page.section(torque(file, evaluation));
    if evaluation.recording.tau.is_some() {
        page = page.section(residuals(file, evaluation));
    }
    page = page.section(compensator(file));
    page = page.section(
        Section::new("Identified parameters")
            .table(
                tables::terms(file)
                    .caption("Friction and memory per joint; ± one standard deviation"),
            )
            .details(Section::new("Base parameters").table(tables::base_parameters(file))),
    );
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

fn torque(file: &ModelFile, evaluation: &Evaluation) -> Section {
    let time = &evaluation.recording.time;
    let rows: Vec<_> = evaluation
        .recording
        .trajectories
        .iter()
        .map(|t| t.range.clone())
        .collect();
    let figures = file.joints.iter().enumerate().map(|(j, name)| {
        let predicted = evaluation.torque.column(j).to_vec();
        let mut upper = Panel::new("torque / N·m");
        let mut plot = Plot::new(name.clone(), "time / s");
        if let Some(tau) = &evaluation.recording.tau {
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
    Section::new("Torque over time").figures(figures)
}

fn residuals(file: &ModelFile, evaluation: &Evaluation) -> Section {
    let motion = &evaluation.session.parts[0].at_samples;
    let figures = file.joints.iter().enumerate().filter_map(|(j, name)| {
        let tau = evaluation.recording.tau.as_ref()?;
        let residual: Vec<f64> = tau
            .column(j)
            .iter()
            .zip(evaluation.torque.column(j))
            .map(|(m, p)| m - p)
            .collect();
        let qd = motion.qd.column(j).to_vec();
        let panel = Panel::new("residual / N·m")
            .height(160.0)
            .points("samples", Ink::Muted, &qd, &residual)
            .binned("mean over bins", Ink::Residual, &qd, &residual, 30);
        Some(
            Plot::new(name.clone(), "velocity / rad/s")
                .half_width()
                .panel(panel)
                .draw(format!("{name}: residual over velocity")),
        )
    });
    Section::new("Residual over velocity")
        .paragraph(
            "A shape here is friction that the model lacks; a bare cloud is noise, or memory.",
        )
        .figures(figures)
}

fn compensator(file: &ModelFile) -> Section {
    let section = Section::new("Compensator");
    let Some(record) = &file.compensator else {
        return section.paragraph("This model has no learned part.");
    };
    let lines = record.validation.iter().map(|v| {
        let figure = |x: Option<f64>| x.map_or_else(|| "–".to_owned(), |x| format!("{x:.4} N·m"));
        format!(
            "{}: {}; error on trajectories held back: physics {}, with the unit {}, with ridge regression on the same inputs {}",
            v.joint, if v.enabled { "on" } else { "off, it did not help" },
            figure(v.physics), figure(v.with_unit), figure(v.with_ridge)
        )
    });
    section
        .callout(Tone::Neutral, "Bounded", "Away from its training inputs the learned torque fades to zero, and it never exceeds what training saw.")
        .list(lines.collect::<Vec<_>>())
}
