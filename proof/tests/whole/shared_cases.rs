//! The shared example cases, where they are there: right answers, and reports as docs/formats.md has them.

use crate::shared;
use datasets::{ReadOptions, read};
use diagnose::NominalModel;
use diagnose::{Options, diagnose};
use physics::robot::Robot;
use proof::prove::judge;
use serde_json::Value;

fn report(folder: &std::path::Path) -> Value {
    let robot = Robot::from_urdf_file(folder.join("robot.urdf")).unwrap();
    let options = ReadOptions::for_robot(robot.dof());
    let data = read(&folder.join("train.parquet"), &options).unwrap();
    let heldout = read(&folder.join("test.parquet"), &options).unwrap();
    let outcome = diagnose(
        &NominalModel::new(robot),
        &data,
        &heldout,
        &Options::default(),
    )
    .unwrap();
    serde_json::to_value(&outcome.diagnosis).unwrap()
}

/// Each of these takes a few seconds; the proof runs the rest.
#[test]
fn names_the_cause_says_none_and_says_unknown() {
    let Some(shared) = shared("cases") else {
        return;
    };
    for (case, verdict) in [
        ("07a6dac1d5", "explained"),
        ("7a6b200351", "no_gap"),
        ("0bee65972c", "unknown_effect"),
    ] {
        let found = report(&shared.join("cases").join(case));
        let truth: Value = serde_json::from_str(
            &std::fs::read_to_string(shared.join(format!("truth/{case}.json"))).unwrap(),
        )
        .unwrap();
        let score = judge(&truth, &found);
        assert_eq!(found["verdict"], verdict, "{case}");
        assert!(score.top1.is_none_or(|s| s == 1.0), "{case}: {score:?}");
        assert!(score.joint.is_none_or(|s| s == 1.0), "{case}: {score:?}");
        assert_ne!(score.false_alarm, Some(1.0), "{case}");
        let shares: Vec<f64> = found["causes"]
            .as_array()
            .unwrap()
            .iter()
            .map(|c| c["share_of_gap"].as_f64().unwrap())
            .collect();
        assert!(shares.is_sorted_by(|a, b| a >= b), "{case}: {shares:?}");
    }
}
