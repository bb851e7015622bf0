//! Sections on the remaining residual, the recordings, and the provenance.

use crate::report::words::unknowable;
use crate::schema::Diagnosis;
use datasets::check::Severity;
use report::{Cell, Column, Section, Table};

/// Section with the structured error, joint by joint.
pub(super) fn left(d: &Diagnosis) -> Section {
    let head = [
        Column::text("joint"),
        Column::number("structured error"),
        Column::number("learnable part"),
        Column::number("left in motion / N·m (N)"),
        Column::number("left at rest"),
        Column::number("floor"),
    ];
    let table = d.unexplained.iter().fold(Table::new(head), |t, u| {
        t.row([
            Cell::text(&u.joint),
            Cell::optional(u.nrmse, 4),
            Cell::optional(u.learnable.map(|l| l.max(0.0)), 2),
            Cell::optional(u.moving, 3),
            Cell::optional(u.standing, 3),
            Cell::optional(u.floor, 3),
        ])
    });
    Section::new("What is left")
        .paragraph(
            "Error away from reversals that lasts longer than noise would or that a flexible learner predicts on trajectories left out, \
             relative to each joint's torque. Above 0.03 something is there that the catalogue does not explain. What is left in \
             motion and at rest is on the fitted recording, out of fold; the floor is the spread of repeated motions, or the torque's \
             noise above the band of the motion.",
        )
        .table(table)
}

/// Section with the check of both recordings, and the effects that they cannot show.
pub(super) fn recordings(d: &Diagnosis) -> Section {
    let mut section = Section::new("The recordings");
    for (what, r) in ["data", "held out"].into_iter().zip(&d.recordings) {
        section = section
            .heading(format!("{what}: {}", r.source))
            .paragraph(format!(
                "{} samples at {:.1} Hz in {} trajectories, {:.0} s.",
                r.samples, r.rate_hz, r.trajectories, r.duration_s
            ));
        if r.findings.is_empty() {
            section = section.paragraph("Nothing is wrong with it.");
        }
        section = section.list(r.findings.iter().map(|f| {
            let weight = match f.severity {
                Severity::Note => "Note",
                Severity::Warning => "Warning",
                Severity::Severe => "Severe",
            };
            format!("{weight}: {}.", f.message)
        }));
    }
    section = section.heading("What was done").list(d.notes.clone());
    let hidden = unknowable(d);
    if !hidden.is_empty() {
        section = section.heading("What they cannot show").list(hidden);
    }
    section
}

/// Section with caveats, inputs and version.
pub(super) fn provenance(inputs: &[(String, String)]) -> Section {
    let mut pairs: Vec<(String, String)> = inputs.to_vec();
    pairs.push(("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()));
    let caveats = vec![
        "Effects were fitted and chosen on the data alone; the torque of the held-out recording reports and chooses nothing but the pushes that are found in it.".to_owned(),
        "A mass is only as right as the torque scale: without a known load, gain and mass cannot be told apart.".to_owned(),
        "Deviations are those of the fit, given the model; they do not hold errors of the kinematics.".to_owned(),
    ];
    Section::new("Caveats and provenance")
        .list(caveats)
        .pairs(pairs)
}
