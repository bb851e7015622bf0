//! `payload --known`: the gains of drives with wrong torque constants, on recordings of a simulated arm.

use model::identify::identification::IdentifyOptions;
use model::physics_fit::{FitOptions, fit_physics};
use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::sync::OnceLock;
use trials::protocols::payload::{Loaded, LoadedArm, loaded};

/// Simulated once: recordings, the model identified from what the wrong drives recorded, and the truth.
fn made() -> &'static (tempfile::TempDir, Loaded) {
    static MADE: OnceLock<(tempfile::TempDir, Loaded)> = OnceLock::new();
    MADE.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let made = loaded(LoadedArm::Ur5, true, 21).unwrap();
        let made = made.with_wrong_drives(21);
        made.write(folder.path()).unwrap();
        let options = FitOptions {
            identify: IdentifyOptions {
                select: false,
                ..IdentifyOptions::default()
            },
            ..FitOptions::default()
        };
        let without = std::slice::from_ref(&made.without);
        let fit = fit_physics(&made.robot, without, None, &options).unwrap();
        let model = folder.path().join("model");
        std::fs::create_dir(&model).unwrap();
        fit.file.save(&model).unwrap();
        (folder, made)
    })
}

fn path(name: &str) -> PathBuf {
    made().0.path().join(name)
}

fn payload(with: &str, more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_payload"))
        .current_dir(made().0.path())
        .args(["--model", "model", "--data", with])
        .args(more)
        .output()
        .unwrap()
}

/// Gains of the recording with the body, of which `known` is known.
fn gains(known: &str) -> Value {
    let file = path(&format!("{}.json", known.len()));
    let name = file.to_str().unwrap();
    let more = [
        "--without",
        "without.parquet",
        "--known",
        known,
        "--json",
        name,
    ];
    let out = payload("with.parquet", &more);
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(0), "{said}");
    let shown = String::from_utf8_lossy(&out.stdout).into_owned();
    assert!(shown.contains("possible links"), "{shown}");
    serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap()
}

/// One line that says what is wrong, exit status 2.
#[track_caller]
fn refused(out: &Output, fragments: &[&str]) {
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(2), "{said}");
    let line = said.lines().find(|l| l.starts_with("error: "));
    for fragment in fragments {
        assert!(line.is_some_and(|l| l.contains(fragment)), "{said}");
    }
}

fn body(count: usize) -> String {
    let body = made().1.body;
    let (c, i) = (body.com(), body.about_com());
    let all = [
        body.mass, c.x, c.y, c.z, i.m11, i.m12, i.m22, i.m13, i.m23, i.m33,
    ];
    let text: Vec<String> = all[..count].iter().map(f64::to_string).collect();
    text.join(",")
}

/// Every gain within four of its deviations, none wider than a tenth, and possible links give nearly the same.
#[track_caller]
fn hold(found: &Value) {
    for (j, truth) in made().1.gains.iter().enumerate() {
        let figure = &found["gain"][j];
        let (Some(value), Some(std)) = (figure["value"].as_f64(), figure["std"].as_f64()) else {
            panic!("joint {j}: {figure}");
        };
        assert!(
            (value - truth).abs() < 4.0 * std,
            "joint {j}: {value} ± {std} of {truth}"
        );
        assert!(std < 0.1 * truth, "joint {j}: {std}");
        let possible = found["possible"][j].as_f64().unwrap();
        assert!(
            (possible / truth - 1.0).abs() < 0.1,
            "joint {j}: {possible} of {truth}"
        );
    }
}

#[test]
fn gains_from_a_body_that_is_known() {
    let found = gains(&body(10));
    assert_eq!(found["schema"], "drive_gains/1");
    hold(&found);
}

#[test]
fn gains_from_mass_and_centre_of_mass() {
    hold(&gains(&body(4)));
}

/// A gram is no scale: the recording without a body is that of a body of a gram.
#[test]
fn a_body_that_is_too_light_is_refused() {
    let more = ["--without", "without.parquet", "--known", "0.001"];
    refused(
        &payload("without.parquet", &more),
        &["without.parquet", "no joint's gain"],
    );
}

#[test]
fn bad_input_is_refused() {
    for known in ["2,0", "-1", "a"] {
        let more = ["--without", "without.parquet", "--known", known];
        refused(&payload("with.parquet", &more), &[known]);
    }
    refused(&payload("with.parquet", &["--known", "2"]), &["required"]);
    let more = ["--without", "none.csv", "--known", "2"];
    refused(&payload("with.parquet", &more), &["none.csv"]);
}
