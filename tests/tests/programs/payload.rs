//! `payload` on recordings of one simulated arm without and with a body.

use physics::robot::Inertia;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tempfile::TempDir;
use tests::csv::Csv;
use tests::program::{json, program, run};
use trials::protocols::payload::{LoadedArm, loaded};

/// Simulated once: files, model, and the body.
fn made() -> &'static (TempDir, Inertia) {
    static MADE: OnceLock<(TempDir, Inertia)> = OnceLock::new();
    MADE.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let made = loaded(LoadedArm::Ur5, true, 21).expect("a possible arm");
        made.write(folder.path()).expect("writable");
        let at = |name: &str| folder.path().join(name);
        let mut train = program("train");
        train.arg("--robot").arg(at("robot.urdf"));
        train.arg("--data").arg(at("without.parquet"));
        train.args(["--physics-only", "--basic", "--quiet", "--out"]);
        run(train.arg(at("model"))).succeeded();
        (folder, made.body)
    })
}

fn path(name: &str) -> PathBuf {
    made().0.path().join(name)
}

/// `payload` on a recording, and its JSON.
fn payload(data: &Path) -> serde_json::Value {
    let out = tempfile::tempdir().expect("a temporary folder");
    let file = out.path().join("payload.json");
    let mut command = program("payload");
    command
        .arg("--model")
        .arg(path("model"))
        .arg("--data")
        .arg(data);
    run(command.arg("--json").arg(&file)).succeeded();
    json(&file)
}

#[track_caller]
fn holds(figure: &serde_json::Value, truth: f64, widest: f64) {
    let (value, std) = (figure["value"].as_f64(), figure["std"].as_f64());
    let (Some(value), Some(std)) = (value, std) else {
        panic!("not told: {figure}");
    };
    assert!(
        (value - truth).abs() < 4.0 * std,
        "{value} ± {std} of {truth}"
    );
    assert!(std < widest, "{std}");
}

#[test]
fn all_ten_parameters_of_a_body() {
    let body = &made().1;
    let found = payload(&path("with.parquet"));
    assert_eq!(found["schema"], "payload/1");
    holds(&found["mass"], body.mass, 0.05 * body.mass);
    let (com, about) = (body.com(), body.about_com());
    for k in 0..3 {
        holds(&found["com"][k], com[k], 0.005);
    }
    let entries = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];
    for (k, entry) in entries.into_iter().enumerate() {
        holds(&found["inertia"][k], about[entry], 0.02);
    }
    let rms = |key: &str| found[key][1].as_f64().expect("a number");
    assert!(rms("rmse_with") < 0.2 * rms("rmse_without"));
}

/// The same recording without its body: nothing beyond the deviations, and no centre of mass of nothing.
#[test]
fn no_body_is_no_mass() {
    let found = payload(&path("without.parquet"));
    holds(&found["mass"], 0.0, 0.1);
    assert!(
        found["com"]
            .as_array()
            .expect("a list")
            .iter()
            .all(|c| c.is_null())
    );
}

/// Two seconds tell mass and centre of mass at best: the inertia is not claimed.
#[test]
fn a_short_motion_claims_four_parameters() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let whole = loaded(LoadedArm::Ur5, true, 21)
        .expect("a possible arm")
        .with;
    let mut csv = Csv::of(&whole);
    csv.rows.truncate(300);
    let file = folder.path().join("short.csv");
    csv.write(&file);
    let found = payload(&file);
    assert!(
        found["inertia"]
            .as_array()
            .expect("a list")
            .iter()
            .all(|c| c.is_null())
    );
    assert!(found["possible"].is_null());
    let notes = found["notes"].to_string();
    assert!(notes.contains("four parameters"), "{notes}");
    if !found["mass"].is_null() {
        holds(&found["mass"], made().1.mass, made().1.mass);
    }
}

#[test]
fn bad_input_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let refuses = |model: &Path, data: &Path, fragments: &[&str]| {
        let mut command = program("payload");
        run(command.arg("--model").arg(model).arg("--data").arg(data)).refused(fragments);
    };
    let with = path("with.parquet");
    refuses(folder.path(), &with, &["model.json"]);
    refuses(
        &path("model"),
        &folder.path().join("none.csv"),
        &["none.csv"],
    );
    let csv = Csv::of(
        &loaded(LoadedArm::Ur5, true, 21)
            .expect("a possible arm")
            .with,
    );
    let torque: Vec<String> = (1..=6).map(|j| format!("tau{j}")).collect();
    let torque: Vec<&str> = torque.iter().map(String::as_str).collect();
    let file = folder.path().join("bare.csv");
    csv.clone().without(&torque).write(&file);
    refuses(&path("model"), &file, &["bare.csv", "tau"]);
    let file = folder.path().join("five.csv");
    csv.without(&["q6", "tau6", "qd6"]).write(&file);
    refuses(&path("model"), &file, &["five.csv"]);
}
