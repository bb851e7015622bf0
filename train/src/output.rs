//! What `train` prints and writes.

use crate::arguments::Arguments;
use datasets::Recording;
use datasets::check::CheckReport;
use model::directory::{ModelFile, json};
use model::failure::Failure;
use model::metrics::{Row, Scope};
use model::physics_fit::Fit;
use model::residual::{Learned, member_torques};
use model::tables;
use serde::Serialize;

/// Contents of `metrics.json`.
#[derive(Serialize)]
pub struct Metrics {
    schema: &'static str,
    joints: Vec<String>,
    train: Vec<Row>,
    heldout: Option<Vec<Row>>,
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
    file: &ModelFile,
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
    file.save(out)?;
    Ok(())
}

/// Prints what a person wants to see first.
pub fn print(file: &ModelFile, metrics: &Metrics, arguments: &Arguments) {
    println!("\nNRMSE on the training recordings");
    print!(
        "{}",
        tables::scores(&file.joints, &metrics.train, &[]).to_text()
    );
    if let Some(rows) = &metrics.heldout {
        println!("\nNRMSE on the held-out recording");
        print!("{}", tables::scores(&file.joints, rows, &[]).to_text());
        print!("\n{}", tables::errors(&file.joints, rows).to_text());
        print_members(rows, &metrics.members);
    }
    println!("\nmodel: {}", arguments.out.display());
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
            println!(
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
        print!("{}", json(&reports));
        return;
    }
    if quiet {
        return;
    }
    for report in reports {
        println!(
            "{}: {} samples, {} trajectories, {:.0} s at {:.1} Hz",
            report.source, report.samples, report.trajectories, report.duration_s, report.rate_hz
        );
        if let Some(r) = &report.repeatability {
            let floor: Vec<String> = r
                .moving
                .iter()
                .map(|v| v.map_or_else(|| "–".into(), |v| format!("{v:.3}")))
                .collect();
            println!(
                "  {} repeated motions; spread in motion {} N·m",
                r.pairs.len(),
                floor.join(" ")
            );
        }
        for finding in &report.findings {
            println!("  {:?}: {}", finding.severity, finding.message);
        }
    }
}
