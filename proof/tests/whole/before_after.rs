//! `diagnose --before`: what has changed between two recordings of one robot, from their files.

use diagnose::{Job, Subject};
use proof::prove::changed::Told;
use serde_json::Value;
use std::path::{Path, PathBuf};
use trials::protocols::changed::{Change, changed};
use trials::protocols::payload::LoadedArm;

/// A robot whose gears do nothing that a rigid model with friction lacks: what is tested is the comparison.
fn days(folder: &Path, change: Change, again: bool) -> Value {
    let days = changed(LoadedArm::Ur5, change, again, true, 5).unwrap();
    days.write(folder).unwrap();
    serde_json::to_value(&days.truth).unwrap()
}

fn job(folder: &Path, heldout: Option<PathBuf>) -> Job {
    let at = |name: &str| folder.join(name);
    let robot = Subject::robot(at("robot.urdf").display().to_string());
    Job {
        heldout,
        fast: true,
        ..Job::since(robot, vec![at("before.parquet")], vec![at("after.parquet")])
    }
}

fn report(folder: &Path) -> Value {
    serde_json::from_str(&job(folder, None).run(|_| ()).unwrap().json()).unwrap()
}

fn size(report: &Value, effect: &str, name: &str) -> f64 {
    let causes = report["causes"].as_array().unwrap();
    let own = causes.iter().find(|c| c["effect"] == effect);
    let own = own.unwrap_or_else(|| panic!("no {effect}: {causes:?}"));
    let parameters = own["parameters"].as_array().unwrap();
    let value = parameters.iter().find(|p| p["name"] == name);
    value.and_then(|p| p["value"].as_f64()).unwrap()
}

/// Weighs a load that was put on by the same motion or by another; returns its true mass, kg, and the days' folder.
fn weighed(again: bool) -> (f64, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let truth = days(folder.path(), Change::Payload, again);
    let found = report(folder.path());
    let mass = size(&found, "payload", "mass");
    let true_mass = truth["size"].as_f64().unwrap();
    assert!((mass / true_mass - 1.0).abs() < 0.05, "{mass} {true_mass}");
    assert_eq!(found["causes"].as_array().unwrap().len(), 1, "{found:#}");
    let share = if again { 1.0 } else { 0.0 };
    for repeated in found["compared"]["repeated"].as_array().unwrap() {
        assert_eq!(repeated.as_f64(), Some(share));
    }
    (true_mass, folder)
}

#[test]
fn a_load_is_weighed_by_another_motion() {
    weighed(false);
}

#[test]
#[ignore = "long: .ci/release"]
fn a_load_is_weighed_by_the_same_motion_and_taken_off() {
    let (true_mass, folder) = weighed(true);
    // Whoever comes later is the later one: taken off, the load is there before.
    let [before, after] = ["before.parquet", "after.parquet"].map(|n| folder.path().join(n));
    std::fs::rename(&before, folder.path().join("kept")).unwrap();
    std::fs::rename(&after, &before).unwrap();
    std::fs::rename(folder.path().join("kept"), &after).unwrap();
    let mass = size(&report(folder.path()), "payload", "mass");
    assert!((mass / true_mass + 1.0).abs() < 0.05, "{mass} {true_mass}");
}

#[test]
fn an_unchanged_robot_has_not_changed() {
    let folder = tempfile::tempdir().unwrap();
    days(folder.path(), Change::None, true);
    let found = report(folder.path());
    assert_eq!(found["verdict"], "no_gap", "{found:#}");
    assert_eq!(found["causes"], Value::Array(Vec::new()));
    assert_eq!(found["ladder"][0]["step"], "as_given");
    // What is fitted measures nothing.
    let after = folder.path().join("after.parquet");
    let error = job(folder.path(), Some(after)).run(|_| ()).map(|_| ());
    let error = error.expect_err("it is refused").to_string();
    assert!(error.contains("after.parquet"), "{error}");
}

#[test]
fn the_judge_knows_a_wrong_answer() {
    let told = |right: bool, more: bool| Told {
        change: Change::Payload,
        again: true,
        right,
        more,
        unknown: false,
        error: right.then_some(0.01),
    };
    let table = proof::prove::changed::table(&[told(true, false), told(false, true)]);
    let text = table.to_text();
    let row = text.lines().find(|l| l.contains("payload")).unwrap();
    let cells: Vec<&str> = row.split_whitespace().collect();
    assert_eq!(&cells[3..5], ["2", "1"], "{text}");
}
