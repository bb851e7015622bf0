//! Diagnosis against an identified model.

use crate::case::{Case, URDF, causes, json, recording, run};
use crate::shared::shared;
use datasets::{ReadOptions, Recording, read};
use model::physics_fit::{FitOptions, fit_physics};
use physics::robot::Robot;
use std::path::Path;

/// Identifies a robot and writes `model.json`.
fn identify(robot: &Robot, data: &[Recording], folder: &Path) {
    std::fs::create_dir_all(folder).unwrap();
    let fit = fit_physics(robot, data, None, &FitOptions::default()).unwrap();
    fit.file.save(folder).unwrap();
}

/// What was identified is no gap; what came afterwards is one.
#[test]
fn names_what_changed_since_the_model_was_identified() {
    let case = Case::new(&recording(0.25, 0.0), &recording(0.25, 0.45));
    case.write("before.csv", &recording(0.0, 0.2));
    let robot = Robot::from_urdf_str(URDF).unwrap();
    let before = read(&case.path("before.csv"), &ReadOptions::for_robot(1)).unwrap();
    identify(&robot, &[before], &case.path("model"));
    let out = case.diagnose(&["--model", "@model"], &["--json", "@r.json", "--learn"]);
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(0), "{said}");
    let report = json(&case.path("r.json"));
    assert_eq!(
        causes(&report)[0],
        "nonlinear_viscous_friction",
        "{report:#}"
    );
    let steps = report["ladder"].as_array().unwrap();
    assert_eq!(steps.last().unwrap()["step"], "learned");
    case.write("a.csv", &recording(0.0, 0.0));
    case.write("b.csv", &recording(0.0, 0.45));
    case.diagnose(&["--model", "@model"], &["--json", "@r.json"]);
    let report = json(&case.path("r.json"));
    assert_eq!(report["verdict"], "no_gap", "{report:#}");
    assert!(causes(&report).is_empty());
}

/// A real UR10e without load: nothing outside friction may be named.
#[test]
fn finds_no_load_on_an_unloaded_robot() {
    let Some(data) = shared("data/ur10e") else {
        return;
    };
    let robot = Robot::from_urdf_file(data.join("robot.urdf")).unwrap();
    let files = ["20_02_12-50sec_12harm.csv", "20_02_19_14harm50sec.csv"];
    let read = |name: &str| read(&data.join(name), &ReadOptions::for_robot(6)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    identify(&robot, &files.map(read), folder.path());
    let path = |p: &Path| p.display().to_string();
    let out = folder.path().join("r.json");
    let run = run(&[
        "--model",
        &path(folder.path()),
        "--data",
        &path(&data.join("20_02_19_15harm50sec.csv")),
        "--heldout",
        &path(&data.join("20_02_10-30sec_12harm.csv")),
        "--json",
        &path(&out),
    ]);
    assert_eq!(run.status.code(), Some(0));
    let report = json(&out);
    for wrong in [
        "payload",
        "base_tilt",
        "torque_gain",
        "joint_coupling",
        "external_contact",
    ] {
        assert!(
            !causes(&report).contains(&wrong),
            "{wrong}: {:#}",
            report["causes"]
        );
    }
    assert!(report["ladder"][0]["mean_nrmse"].as_f64().unwrap() < 0.1);
}
