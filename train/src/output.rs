//! What `train` prints and writes.

use crate::arguments::Arguments;
use crate::input::Input;
use datasets::Recording;
use datasets::check::CheckReport;
use datasets::metrics::{Row, Scope};
use model::baseline::published::{Part, Published, beside};
use model::diagnostics::Diagnostics;
use model::directory::{BaseParameter, json};
use model::failure::Failure;
use model::page::Subject;
use model::physics_fit::Fit;
use model::residual::{Learned, member_torques};
use model::tables;
use serde::Serialize;
use std::cmp::Reverse;

/// Name of the report page in the model directory.
const PAGE: &str = "report.html";

/// Contents of `metrics.json`.
#[derive(Serialize)]
pub struct Metrics {
    schema: &'static str,
    joints: Vec<String>,
    train: Vec<Row>,
    heldout: Option<Vec<Row>>,
    /// Identified parameters.
    base_parameters: Vec<BaseParameter>,
    /// How well they stand.
    diagnostics: Option<Diagnostics>,
    /// Each member of the ensembles alone on the held-out recording.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    members: Vec<Member>,
}

/// Mean NRMSE of one seed.
#[derive(Serialize)]
struct Member {
    member: usize,
    mean_nrmse: Option<f64>,
    mean_nrmse_moving: Option<f64>,
}

/// Rows of one recording of the session.
pub fn rows(
    fit: &Fit,
    learned: Option<&Learned>,
    part: usize,
    recording: &Recording,
) -> Result<Vec<Row>, Failure> {
    let mut rows = fit.rows(part, recording)?;
    if let (Some(learned), Some(tau)) = (learned, &recording.tau) {
        let torque = &fit.physics[part] + &learned.torque[part];
        let qd = &fit.session.parts[part].at_samples.qd;
        rows.extend(
            Row::both_scopes("physics+compensator", tau, &torque, qd)
                .map_err(|e| Failure::other(e.to_string()))?,
        );
    }
    Ok(rows)
}

/// Metrics of the first training recording set and the held-out one.
pub fn metrics(
    fit: &Fit,
    learned: Option<&Learned>,
    data: &[Recording],
    heldout: Option<&Recording>,
) -> Result<Metrics, Failure> {
    let mut train = Vec::new();
    for (part, recording) in data.iter().enumerate() {
        let mut own = rows(fit, learned, part, recording)?;
        if data.len() > 1 {
            for row in &mut own {
                row.name = format!(
                    "{} [{}]",
                    row.name, fit.file.provenance.recordings[part].name
                );
            }
        }
        train.extend(own);
    }
    let members = match (learned, heldout) {
        (Some(learned), Some(recording)) => members(fit, learned, data.len(), recording)?,
        _ => Vec::new(),
    };
    let heldout = heldout
        .map(|recording| rows(fit, learned, data.len(), recording))
        .transpose()?;
    Ok(Metrics {
        schema: "metrics/1",
        joints: fit.file.joints.clone(),
        train,
        heldout,
        base_parameters: fit.file.base_parameters.clone(),
        diagnostics: fit.file.diagnostics.clone(),
        members,
    })
}

/// Scores of each member alone.
fn members(
    fit: &Fit,
    learned: &Learned,
    part: usize,
    recording: &Recording,
) -> Result<Vec<Member>, Failure> {
    let Some(tau) = &recording.tau else {
        return Ok(Vec::new());
    };
    let qd = &fit.session.parts[part].at_samples.qd;
    member_torques(learned, fit, part)?
        .iter()
        .enumerate()
        .map(|(member, residual)| {
            let torque = &fit.physics[part] + residual;
            let [all, moving] = Row::both_scopes("member", tau, &torque, qd)
                .map_err(|e| Failure::other(e.to_string()))?;
            Ok(Member {
                member,
                mean_nrmse: all.scores.mean_nrmse,
                mean_nrmse_moving: moving.scores.mean_nrmse,
            })
        })
        .collect()
}

/// Writes the directory: `model.json` last, so that a directory with one is whole.
pub fn write(
    arguments: &Arguments,
    learned: Option<&Learned>,
    metrics: &Metrics,
    fit: &Fit,
) -> Result<(), Failure> {
    let out = &arguments.out;
    let failed = |e: std::io::Error| Failure::other(format!("{}: {e}", out.display()));
    std::fs::create_dir_all(out).map_err(failed)?;
    let weights = out.join("compensator.safetensors");
    match learned {
        Some(learned) => learned
            .compensator
            .save(&weights)
            .map_err(|e| Failure::other(e.to_string()))?,
        None if weights.exists() => std::fs::remove_file(&weights).map_err(failed)?,
        None => {}
    }
    report::write_atomic(&out.join("metrics.json"), &json(metrics))?;
    if let Some(urdf) = model::urdf::identified(fit) {
        report::write_atomic(&out.join("identified.urdf"), &urdf)?;
    }
    fit.file.save(out)?;
    Ok(())
}

/// Writes the page of the held-out recording or, without one, of the longest training recording.
pub fn page(
    arguments: &Arguments,
    fit: &Fit,
    learned: Option<&Learned>,
    metrics: &Metrics,
    input: &Input,
) -> Result<(), Failure> {
    let longest = (0..input.data.len()).max_by_key(|&i| (input.data[i].len(), Reverse(i)));
    let (part, recording) = match (&input.heldout, longest) {
        (Some(heldout), _) => (input.data.len(), heldout),
        (None, Some(i)) => (i, &input.data[i]),
        (None, None) => return Ok(()),
    };
    let torque = match learned {
        Some(learned) => &fit.physics[part] + &learned.torque[part],
        None => fit.physics[part].clone(),
    };
    let rows = match &metrics.heldout {
        Some(rows) => rows.clone(),
        None => rows(fit, learned, part, recording)?,
    };
    let scored = if input.heldout.is_some() {
        "Scores and figures are of the held-out recording: nothing was fitted to its torque."
    } else {
        "No recording was held out: scores and figures are of samples that were fitted, and say nothing about new motion."
    };
    let mut notes = vec![scored.to_owned()];
    notes.extend(model::evaluation::notes(&fit.session, part, &fit.file));
    let published = published(fit, input.heldout.is_some());
    let page = model::page::page(
        &fit.file,
        &Subject {
            recording,
            motion: &fit.session.parts[part].at_samples,
            torque: &torque,
            rows: &rows,
            notes: &notes,
            published: &published,
        },
    );
    report::write_atomic(&arguments.out.join(PAGE), &page.render())?;
    Ok(())
}

fn published(fit: &Fit, heldout: bool) -> Vec<&'static Published> {
    let part = if heldout { Part::Test } else { Part::Train };
    beside(fit.file.physics.builtin, &[part])
}

/// Prints what a person wants to see, the scores last.
pub fn print(fit: &Fit, metrics: &Metrics, arguments: &Arguments) {
    let file = &fit.file;
    if let Some(d) = &file.diagnostics {
        report::say!("\nBase parameters");
        report::say_text!(tables::base_parameters(file).to_text());
        report::say!("\nCondition numbers of the weighted regressor");
        report::say_text!(tables::conditioning(&d.conditioning).to_text());
        report::say!("\nResidual of the physics on the training recordings");
        let tests = tables::residual_tests(&file.joints, &d.residual_tests);
        report::say_text!(tests.to_text());
        if !d.links.is_empty() {
            report::say!(
                "\nLinks of the identified URDF: eigenvalues of the pseudo-inertia over the largest"
            );
            report::say_text!(tables::links(d).to_text());
        }
        for line in tables::estimator(file, d) {
            report::say!("{line}");
        }
    }
    scores("the training recordings", fit, &metrics.train, false);
    if let Some(rows) = &metrics.heldout {
        scores("the held-out recording", fit, rows, true);
        report::say!();
        report::say_text!(tables::errors(&file.joints, rows).to_text());
        print_members(rows, &metrics.members);
    }
    report::say!(
        "\nmodel: {}\nreport: {}",
        arguments.out.display(),
        arguments.out.join(PAGE).display()
    );
}

fn scores(of: &str, fit: &Fit, rows: &[Row], heldout: bool) {
    let (joints, published) = (&fit.file.joints, published(fit, heldout));
    report::say!("\nNRMSE on {of}");
    report::say_text!(tables::scores(joints, rows, &published).to_text());
    if let Some(table) = tables::forward(joints, rows, &published) {
        report::say!("NRMSE of positions that a linear model simulates from the torque of {of}");
        report::say_text!(table.to_text());
    }
}

/// The spread of seeds, in both scopes.
fn print_members(rows: &[Row], members: &[Member]) {
    let one = |figure: Option<f64>| figure.map_or_else(|| "–".to_owned(), |v| format!("{v:.4}"));
    for scope in Scope::BOTH {
        let whole = rows
            .iter()
            .find(|r| r.name == "physics+compensator" && r.scope == scope);
        let alone: Vec<String> = members
            .iter()
            .map(|m| match scope {
                Scope::All => one(m.mean_nrmse),
                Scope::Moving => one(m.mean_nrmse_moving),
            })
            .collect();
        if let (Some(whole), false) = (whole, alone.is_empty()) {
            report::say!(
                "seeds, {}: mean NRMSE {} (members {})",
                scope.name(),
                one(whole.scores.mean_nrmse),
                alone.join(" ")
            );
        }
    }
}

/// Prints the check of recordings, as text or JSON.
pub fn check(reports: &[CheckReport], as_json: bool, quiet: bool) {
    if as_json {
        report::say_text!(json(&reports));
        return;
    }
    if quiet {
        return;
    }
    for report in reports {
        report::say!(
            "{}: {} samples, {} trajectories, {:.0} s at {:.1} Hz",
            report.source,
            report.samples,
            report.trajectories,
            report.duration_s,
            report.rate_hz
        );
        if let Some(r) = &report.repeatability {
            let floor: Vec<String> = r
                .moving
                .iter()
                .map(|v| v.map_or_else(|| "–".into(), |v| format!("{v:.3}")))
                .collect();
            report::say!(
                "  {} repeated motions; spread in motion {} N·m",
                r.pairs.len(),
                floor.join(" ")
            );
        }
        for finding in &report.findings {
            report::say!("  {:?}: {}", finding.severity, finding.message);
        }
    }
}
