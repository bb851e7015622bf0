//! The program from arguments to files.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_decoupled"))
        .args(arguments)
        .output()
        .unwrap()
}

/// Standard output of a run that went well.
#[track_caller]
fn good(arguments: &[&str]) -> String {
    let out = run(arguments);
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(0), "{said}");
    String::from_utf8(out.stdout).unwrap()
}

/// One line that says what is wrong, exit status 2.
#[track_caller]
fn refused(arguments: &[&str], fragment: &str) {
    let out = run(arguments);
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(said.contains(fragment), "no `{fragment}` in {said}");
    assert!(!said.contains("panicked"), "{said}");
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn three_runs_give_the_axis_back() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| -> PathBuf { folder.path().join(name) };
    let text = |name: &str| at(name).to_str().unwrap().to_owned();
    good(&["simulate", "--axis", "2", "--seed", "3", "--out", &text("")]);
    let (periodic, found) = (text("periodic.parquet"), text("found.json"));
    let said = good(&["identify", "--data", &periodic, "--json", &found]);
    assert!(
        said.contains("correlation of the projected torque"),
        "{said}"
    );
    let truth = json(&at("truth.json"));
    let found = json(&at("found.json"));
    let estimates = found["estimates"].as_array().unwrap();
    let of = |name: &str| {
        let pair = estimates.iter().find(|e| e[0] == name).unwrap();
        (
            pair[1]["parameters"][0].as_f64().unwrap(),
            pair[1]["std"][0].as_f64().unwrap(),
        )
    };
    let inertia = truth["inertia"].as_f64().unwrap();
    for name in ["projection", "instruments", "likelihood"] {
        let (value, std) = of(name);
        assert!(
            (value - inertia).abs() < 4.0 * std && std < 0.05 * inertia,
            "{name}: {value} ± {std}"
        );
    }
    // Differences of noise have nothing of the inertia.
    assert!(of("least-squares").0 < 0.01 * inertia);
    let said = good(&[
        "friction",
        "--bang-bang",
        &text("bang-bang.parquet"),
        "--slopes",
        &text("slopes.parquet"),
    ]);
    assert!(said.contains("q^off") && said.contains("β^c−"), "{said}");

    refused(
        &["identify", "--data", &text("slopes.parquet")],
        "no Fourier series",
    );
    refused(
        &["identify", "--data", &periodic, "--axis", "2"],
        "no axis 2",
    );
    refused(
        &["identify", "--data", &periodic, "--fundamental-hz", "0.01"],
        "less than one period",
    );
    refused(
        &[
            "friction",
            "--bang-bang",
            &text("bang-bang.parquet"),
            "--slopes",
            &periodic,
        ],
        "at constant speed",
    );
    refused(&["control", "--axis", "7"], "no axis 7");
    refused(&["study", "--draws", "1"], "--draws");
    let bare = at("bare.csv");
    std::fs::write(&bare, "time,q1,tau1\n0,0,0\n0.001,0,0\n0.002,0,0\n0.003,0,0\n0.004,0,0\n0.005,0,0\n0.006,0,0\n0.007,0,0\n0.008,0,0\n0.009,0,0\n0.010,0,0\n").unwrap();
    refused(&["identify", "--data", bare.to_str().unwrap()], "bare.csv");
}

#[test]
fn the_model_in_the_loop_helps() {
    let said = good(&["control", "--axis", "6"]);
    let rms = |name: &str| -> f64 {
        let line = said
            .lines()
            .find(|l| l.starts_with("6 ") && l.contains(name))
            .unwrap();
        let numbers: Vec<f64> = line
            .split_whitespace()
            .filter_map(|w| w.parse().ok())
            .collect();
        numbers[1]
    };
    // Axis, then RMS: with the model less than a tenth.
    assert!(rms("PID + model") < 0.1 * rms("PID  "), "{said}");
}
