//! Output of `train`: a short first screen, and with `--verbose` all details.

use crate::arguments::Arguments;
use crate::output::{PAGE, published};
use datasets::check::{CheckReport, Finding, Severity};
use datasets::metrics::{Row, Scope};
use model::directory::ModelFile;
use model::directory::metrics::{Member, Metrics};
use model::physics_fit::Fit;
use model::tables;
use report::{say, say_text};
use std::path::Path;

/// Width of the first screen.
const WIDTH: usize = 100;
/// Largest number of lines on points to check.
const LOOK_AT: usize = 5;
/// Mean NRMSE from which the user is warned of a joint.
const POOR: f64 = 0.3;

/// Prints the first screen: what the model learned, its scores, points to check, and paths of the files.
pub fn first(
    fit: &Fit,
    metrics: &Metrics,
    checks: &[CheckReport],
    warned: &[String],
    arguments: &Arguments,
) {
    let file = &fit.file;
    let known = file.base_parameters.len()
        - file
            .diagnostics
            .as_ref()
            .map_or(0, |d| d.poorly_determined.len());
    say!(
        "\nLearned: {} base parameters of the rigid body, {known} of them to 30 % or better, and friction in N·m at\n\
         each joint's top speed (rad/s) and, slow, at a tenth of it:\n",
        file.base_parameters.len()
    );
    let motions: Vec<_> = fit.session.parts[..file.provenance.recordings.len()]
        .iter()
        .map(|part| &part.at_samples)
        .collect();
    say_text!(tables::friction(file, &motions).to_text());
    let (rows, of) = match &metrics.heldout {
        Some(rows) => (
            rows,
            "on the held-out recording, which nothing was fitted to",
        ),
        None => (
            &metrics.train,
            "on the training recordings; --heldout FILE tells how good it is on others",
        ),
    };
    if let Some(table) = tables::errors_by_joint(&file.joints, &useful(rows)) {
        say!("\nNRMSE (error over the torque's deviation) {of}:\n");
        say_text!(table.to_text());
    }
    let mut lines = warned.to_vec();
    lines.extend(followed(file));
    lines.extend(untried(file));
    lines.extend(look_at(fit, metrics, checks));
    if !lines.is_empty() {
        say!("\nLook at:");
        for line in lines.iter().take(LOOK_AT) {
            say_text!(report::wrapped(line, WIDTH, "  "));
        }
        if lines.len() > LOOK_AT {
            say!("  {} more: --verbose", lines.len() - LOOK_AT);
        }
    }
    places(&arguments.out);
}

/// Lines on joints whose residual follows another joint's motion, where the unit that sees it is on.
fn followed(file: &ModelFile) -> impl Iterator<Item = String> {
    let units = file.compensator.iter().flat_map(|c| &c.validation);
    let on = units.filter(|u| u.enabled);
    on.filter_map(|unit| {
        let others = unit.sees()?;
        Some(format!(
            "{}: the torque that the physics leaves follows {others}, as that of a cable or a hose may; its learned unit sees that, too",
            unit.joint
        ))
    })
}

/// A line where no network was tried on motion that it was not trained on.
fn untried(file: &ModelFile) -> Option<String> {
    let units = &file.compensator.as_ref()?.validation;
    let untried = units.iter().all(|unit| unit.with_unit.is_none());
    (untried && !units.is_empty()).then(|| {
        "The learned units were not tried on motion held back, for the training has one trajectory: none is switched off where it \
         does not help. Compare `physics` and `physics+compensator` on a held-out recording; where it is no better, train with \
         --physics-only, or give several runs, marked in the column `trajectory`."
            .to_owned()
    })
}

/// Prints the paths of the results.
fn places(out: &Path) {
    say!(
        "\nmodel: {}\nreport: {}",
        out.display(),
        out.join(PAGE).display()
    );
}

/// Points to check before relying on the model, most serious first.
fn look_at(fit: &Fit, metrics: &Metrics, checks: &[CheckReport]) -> Vec<String> {
    let file = &fit.file;
    let mut lines = findings(checks, Severity::Severe);
    let rows = metrics.heldout.as_ref().unwrap_or(&metrics.train);
    let last = rows
        .iter()
        .rfind(|r| r.scope == Scope::All && r.name.starts_with("physics"));
    if let Some(row) = last {
        let poor: Vec<&str> = std::iter::zip(&file.joints, &row.scores.nrmse)
            .filter(|(_, v)| v.is_some_and(|v| v > POOR))
            .map(|(joint, _)| joint.as_str())
            .collect();
        if !poor.is_empty() {
            lines.push(format!(
                "{}: NRMSE above {POOR}; diagnose says which effect is missing.",
                poor.join(", ")
            ));
        }
    }
    if let Some(f) = file.preprocessing.torque_filter.filter(|f| f.recognised) {
        lines.push(format!(
            "The torque was low-passed before it was stored: half power at {:.2} Hz, and nothing above. Scores compare with the prediction \
             behind the same filter (cutoff_hz = {:.3}, the end of its pass band), and so does `eval --predict`. A control loop gives the \
             unfiltered torque, which these scores do not judge.",
            f.half_power_hz(),
            f.cutoff_hz
        ));
    }
    lines.extend(findings(checks, Severity::Warning));
    lines
}

/// Findings of one severity, those of a kind in one line.
fn findings(checks: &[CheckReport], severity: Severity) -> Vec<String> {
    let all: Vec<&Finding> = checks
        .iter()
        .flat_map(|c| c.findings.iter().filter(|f| !c.is_told(f)))
        .filter(|f| f.severity == severity)
        .collect();
    let complaints = checks.iter().flat_map(|c| &c.doctor);
    let mut lines: Vec<String> = complaints
        .filter(|c| c.severity == severity)
        .map(|c| format!("{}: {}. That is {}.", c.ailment.title(), c.seen, c.means))
        .collect();
    for (i, finding) in all.iter().enumerate() {
        if all[..i].iter().any(|f| f.kind == finding.kind) {
            continue;
        }
        let alike = all.iter().filter(|f| f.kind == finding.kind).count();
        lines.push(match alike {
            1 => format!("{}.", finding.message),
            n => format!("{} ({} more like it).", finding.message, n - 1),
        });
    }
    lines
}

/// Prints everything: parameters, conditioning, residuals, scores of every scope.
pub fn everything(fit: &Fit, metrics: &Metrics, warned: &[String], arguments: &Arguments) {
    let file = &fit.file;
    if let Some(d) = &file.diagnostics {
        say!("\nBase parameters");
        say_text!(tables::base_parameters(file).to_text());
        say!("\nFriction and other terms");
        say_text!(tables::terms(file).to_text());
        say!("\nCondition numbers of the weighted regressor");
        say_text!(tables::conditioning(&d.conditioning).to_text());
        say!("\nResidual of the physics on the training recordings");
        let tests = tables::residual_tests(&file.joints, &d.residual_tests);
        say_text!(tests.to_text());
        if !d.links.is_empty() {
            say!(
                "\nLinks of the identified URDF: eigenvalues of the pseudo-inertia over the largest"
            );
            say_text!(tables::links(d).to_text());
        }
        for line in tables::estimator(file, d) {
            say!("{line}");
        }
    }
    scores("the training recordings", fit, &metrics.train, false);
    for line in warned {
        say_text!(report::wrapped(&format!("\n{line}."), WIDTH, ""));
    }
    if let Some(rows) = &metrics.heldout {
        scores("the held-out recording", fit, rows, true);
        say!();
        say_text!(tables::errors(&file.joints, rows).to_text());
        members(rows, &metrics.members);
    }
    places(&arguments.out);
}

/// Mean NRMSE beyond which a baseline is not printed. A prediction of zero has one of 1.
const NO_USE: f64 = 2.0;

/// The rows without baselines that run away.
fn useful(rows: &[Row]) -> Vec<Row> {
    let runs_away = |r: &&Row| {
        let error = r.scores.mean_nrmse;
        r.name.contains("baseline") && error.is_some_and(|e| e.is_nan() || e > NO_USE)
    };
    rows.iter().filter(|r| !runs_away(r)).cloned().collect()
}

fn scores(of: &str, fit: &Fit, rows: &[Row], heldout: bool) {
    let kept = useful(rows);
    let gone = rows
        .iter()
        .filter(|r| r.scope == Scope::All && kept.iter().all(|k| k.name != r.name));
    for row in gone {
        say!(
            "\n{} is of no use on {of}: its error is beyond twice the signal",
            row.name
        );
    }
    let rows = kept.as_slice();
    let (joints, published) = (&fit.file.joints, published(fit, heldout));
    say!("\nNRMSE on {of}");
    say_text!(tables::scores(joints, rows, &published).to_text());
    if let Some(table) = tables::forward(joints, rows, &published) {
        say!("NRMSE of positions that a linear model simulates from the torque of {of}");
        say_text!(table.to_text());
    }
}

/// The spread of seeds, in both scopes.
fn members(rows: &[Row], members: &[Member]) {
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
            say!(
                "seeds, {}: mean NRMSE {} (members {})",
                scope.name(),
                one(whole.scores.mean_nrmse),
                alone.join(" ")
            );
        }
    }
}
