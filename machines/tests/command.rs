//! The command line: one run through all commands with a drive file, and what is refused.

use std::path::Path;
use std::process::{Command, Output};

fn machine(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_machine"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("machine runs")
}

fn done(folder: &Path, arguments: &[&str]) -> String {
    let out = machine(folder, arguments);
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(0), "{arguments:?}: {said}");
    String::from_utf8(out.stdout).expect("text")
}

/// Milliseconds, other names, the other direction and per mille of rated current are the same machine by its drive file.
#[test]
fn a_recording_as_a_drive_has_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let simulate = [
        "simulate",
        "--robot",
        "linear_axis",
        "--out",
        "sim",
        "--format",
        "csv",
        "--rate",
        "250",
    ];
    assert_eq!(done(at, &simulate).lines().count(), 2);
    let plain = [
        "identify",
        "--robot",
        "linear_axis",
        "--data",
        "sim/linear_axis-identification.csv",
        "--out",
        "plain",
        "--quiet",
    ];
    assert!(done(at, &plain).is_empty());

    // Per mille of 4 A · 0.12 N·m/A · gear 2 · 2π / 20 mm.
    let factor = 4.0e-3 * 0.12 * 2.0 * std::f64::consts::TAU / 0.02;
    let text = std::fs::read_to_string(at.join("sim/linear_axis-identification.csv")).expect("csv");
    let mut lines = text.lines();
    let header = lines.next().expect("a header");
    assert_eq!(header, "trajectory,time,q1,tau1");
    let mut table = String::from("stamp,position,current\n");
    for line in lines {
        let cells: Vec<f64> = line
            .split(',')
            .skip(1)
            .map(|c| c.parse().expect("a number"))
            .collect();
        table.push_str(&format!(
            "{},{},{}\n",
            1e3 * cells[0],
            -cells[1],
            -cells[2] / factor
        ));
    }
    std::fs::write(at.join("drive.csv"), table).expect("written");
    std::fs::write(
        at.join("drive.toml"),
        "rated_current = [4]\ntorque_constant = [0.12]\ngear_ratio = [2]\nscrew_lead = [0.02]\ndirection = [-1]\n\
         torque_delay = [3]\ntorque_threshold = [100]\n[columns]\ntime = \"stamp\"\nq1 = \"position\"\ntau1 = \"current\"\n\
         [units]\ntime = \"ms\"\ntorque = \"rated\"\n",
    )
    .expect("written");
    let drive = [
        "identify",
        "--robot",
        "linear_axis",
        "--data",
        "drive.csv",
        "--drive",
        "drive.toml",
        "--out",
        "model",
    ];
    let said = done(at, &drive);
    assert!(said.contains("beyond its torque_threshold"), "{said}");
    let mass = |folder: &str| -> f64 {
        let text = std::fs::read_to_string(at.join(folder).join("machine.json")).expect("json");
        let json: serde_json::Value = serde_json::from_str(&text).expect("json");
        json["parameters"][0]["value"].as_f64().expect("a mass")
    };
    assert!((mass("plain") - 25.0).abs() < 0.3);
    assert!((mass("model") - mass("plain")).abs() < 1e-3);
    let program = std::fs::read_to_string(at.join("model/IDNT1.PRG")).expect("a program");
    assert!(program.contains("ATTACH A1") && program.contains("A1.AdditiveTorqueDelay = 3"));
    assert!(at.join("model/IDNT1.REC").exists());

    let heldout = "sim/linear_axis-heldout.csv";
    let eval = [
        "eval",
        "--model",
        "model",
        "--data",
        heldout,
        "--json",
        "scores.json",
    ];
    assert!(done(at, &eval).contains("within 50 %"));
    let scores = std::fs::read_to_string(at.join("scores.json")).expect("json");
    let scores: serde_json::Value = serde_json::from_str(&scores).expect("json");
    assert!(scores["relative_rms"][0].as_f64().expect("a figure") < 0.03);

    // Prediction does without torque.
    let text = std::fs::read_to_string(at.join(heldout)).expect("csv");
    let motion: String = text
        .lines()
        .map(|l| format!("{}\n", l.rsplit_once(',').expect("cells").0))
        .collect();
    std::fs::write(at.join("motion.csv"), &motion).expect("written");
    done(
        at,
        &[
            "eval",
            "--model",
            "model",
            "--data",
            "motion.csv",
            "--predict",
            "torque.csv",
        ],
    );
    let torque = std::fs::read_to_string(at.join("torque.csv")).expect("csv");
    assert!(torque.starts_with("trajectory,time,tau1\n"));
    assert_eq!(torque.lines().count(), motion.lines().count());
}

#[test]
fn refusals_say_why_and_end_with_status_2() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    std::fs::write(
        at.join("ball.toml"),
        done(at, &["list", "--toml", "delta3"]).replace("\"rotary\"", "\"ball\""),
    )
    .expect("written");
    std::fs::write(
        at.join("short.csv"),
        "time,q1,q2,q3,tau1,tau2,tau3\n0,0,0,0,0,0,0\n",
    )
    .expect("written");
    let refused: [(&[&str], &str); 6] = [
        (
            &["identify", "--robot", "ur5", "--data", "short.csv"],
            "no built-in machine",
        ),
        (
            &["identify", "--robot", "ball.toml", "--data", "short.csv"],
            "unknown variant `ball`",
        ),
        (
            &["identify", "--robot", "delta3", "--data", "short.csv"],
            "at least 20 are needed",
        ),
        (
            &["identify", "--robot", "scara4", "--data", "short.csv"],
            "the robot has 4",
        ),
        (
            &[
                "identify",
                "--robot",
                "delta3",
                "--data",
                "none.csv",
                "--dynamic-model",
                "7",
            ],
            "has 1 to 2",
        ),
        (
            &["eval", "--model", "nowhere", "--data", "short.csv"],
            "cannot be read",
        ),
    ];
    for (arguments, expected) in refused {
        let out = machine(at, arguments);
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(expected), "{arguments:?}: {said}");
        assert!(
            said.starts_with("error: ") && !said.contains("panicked"),
            "{said}"
        );
    }
    assert!(done(at, &["list"]).contains("forearm_mass"));
}
