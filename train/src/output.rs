//! What `train` prints and writes.

use crate::arguments::Arguments;
use datasets::Recording;
use datasets::check::CheckReport;
use model::directory::{ModelFile, json};
use model::failure::Failure;
use model::metrics::Row;
use model::physics_fit::Fit;
use model::residual::Learned;
use model::tables;
use serde::Serialize;

/// Contents of `metrics.json`.
#[derive(Serialize)]
pub struct Metrics {
    schema: &'static str,
    joints: Vec<String>,
    train: Vec<Row>,
    heldout: Option<Vec<Row>>,
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
    let heldout = heldout
        .map(|recording| rows(fit, learned, data.len(), recording))
        .transpose()?;
    Ok(Metrics {
        schema: "metrics/1",
        joints: fit.file.joints.clone(),
        train,
        heldout,
    })
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
    }
    println!("\nmodel: {}", arguments.out.display());
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
