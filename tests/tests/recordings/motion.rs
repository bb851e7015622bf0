//! The gap in motion on real robots: commands and encoders, no torque.

use serde_json::Value;
use std::path::{Path, PathBuf};
use tests::program::{json, program, run};
use tests::shared::shared;

fn replay(robot: &Path, more: &[&str], data: &[PathBuf], heldout: &Path) -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    let report = folder.path().join("report.json");
    let mut command = program("replay");
    command
        .arg("--robot")
        .arg(robot)
        .args(more)
        .arg("--data")
        .args(data);
    command
        .arg("--heldout")
        .arg(heldout)
        .arg("--fast")
        .arg("--json")
        .arg(&report);
    run(&mut command).succeeded();
    json(&report)
}

fn unexplained(step: &Value) -> f64 {
    step["mean_unexplained"].as_f64().expect("a figure")
}

/// Means over joints of the makers' models as given were computed in MuJoCo; what is left is measured on motions that were not
/// fitted.
#[test]
fn unitree_z1_follows_its_commands() {
    let Some(folder) = shared("data/z1") else {
        return;
    };
    let drive = folder.join("drive.toml");
    let report = replay(
        &folder.join("z1.xml"),
        &["--drive", drive.to_str().expect("a path")],
        &[folder.join("train.parquet")],
        &folder.join("test.parquet"),
    );
    let ladder = report["ladder"].as_array().expect("steps");
    assert!(
        (unexplained(&ladder[0]) - 0.54).abs() < 0.01,
        "as given: {}",
        ladder[0]
    );
    let last = ladder.last().expect("steps");
    assert!(unexplained(last) <= 0.08, "corrected: {last}");
    assert_eq!(report["causes"][0]["effect"], "friction_parameters");
    for delay in report["controller"]["delay"].as_array().expect("delays") {
        assert!(
            delay.as_f64().expect("a number") >= 0.0,
            "no drive is early"
        );
    }
}

#[test]
fn so101_has_other_servos_than_its_model() {
    let Some(folder) = shared("data/so101") else {
        return;
    };
    let joints = "shoulder_pan,shoulder_lift,elbow_flex,wrist_flex,wrist_roll";
    let report = replay(
        &folder.join("so101.xml"),
        &["--joints", joints],
        &["multisine", "prbs_excitation"].map(|name| folder.join(format!("{name}.parquet"))),
        &folder.join("friction_gravity.parquet"),
    );
    let ladder = report["ladder"].as_array().expect("steps");
    assert!(
        (unexplained(&ladder[0]) - 0.96).abs() < 0.01,
        "as given: {}",
        ladder[0]
    );
    let last = ladder.last().expect("steps");
    assert!(unexplained(last) <= 0.16, "corrected: {last}");
    let gain = &report["causes"][0];
    assert_eq!(gain["effect"], "servo_gain");
    assert_eq!(gain["joints"].as_array().expect("joints").len(), 5);
}
