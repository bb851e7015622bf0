//! One motion that was executed twice, as by an arm with sensors behind its gears: torque wanders slowly, otherwise
//! each time.

use super::kinds::{Urdf, robot};
use datasets::Recording;
use physics::robot::Robot;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use std::f64::consts::TAU;
use tests::program::{json, program, run};
use tests::synthetic::{Plan, record};

/// Waves of the slow torque, their frequencies in Hz, and its part of a joint's torque.
const WAVES: usize = 12;
const SLOW: std::ops::Range<f64> = 0.05..0.5;
const PART: f64 = 0.04;

/// The motion, executed for the `execution`-th time.
fn executed(robot: &Robot, execution: u64) -> Recording {
    let plan = Plan {
        trajectories: 1,
        seconds: 24.0,
        seed: 31,
        ..Plan::default()
    };
    let mut recording = record(robot, &plan);
    let mut rng = ChaCha8Rng::seed_from_u64(execution);
    let tau = recording.tau.as_mut().expect("torque was recorded");
    for mut column in tau.columns_mut() {
        let size = PART * column.std(0.0) * (2.0 / WAVES as f64).sqrt();
        for _ in 0..WAVES {
            let [rate, phase] = [rng.random_range(SLOW), rng.random_range(0.0..TAU)];
            let each = column.iter_mut().zip(&recording.time);
            each.for_each(|(tau, t)| *tau += size * (TAU * rate * t + phase).sin());
        }
    }
    recording
}

fn compared(before: &Recording, after: &Recording) -> (Value, String) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("arm.urdf"), Urdf::default().text()).expect("writable");
    for (name, recording) in [("before.csv", before), ("after.csv", after)] {
        datasets::write(recording, &path(name)).expect("writable");
    }
    let mut diagnose = program("diagnose");
    diagnose.arg("--robot").arg(path("arm.urdf"));
    diagnose.arg("--before").arg(path("before.csv"));
    diagnose.arg("--data").arg(path("after.csv"));
    let ended = run(diagnose.arg("--json").arg(path("d.json")));
    (json(&path("d.json")), ended.succeeded().out.clone())
}

#[test]
fn nothing_has_changed_between_two_executions_until_something_has() {
    let arm = robot(0);
    let before = executed(&arm, 1);
    let (report, said) = compared(&before, &executed(&arm, 2));
    assert_eq!(report["verdict"], "no_gap", "{said}");
    assert_eq!(report["causes"].as_array().map(Vec::len), Some(0), "{said}");
    assert!(said.contains("Nothing has changed beyond noise"), "{said}");
    // Half a kilogram more at the end.
    let load = r#"<link name="load"><inertial><mass value="0.5"/><inertia ixx="4e-4" ixy="0" ixz="0" iyy="4e-4" iyz="0" izz="4e-4"/></inertial></link>
<joint name="held" type="fixed"><parent link="l3"/><child link="load"/><origin xyz="0 0 0.3"/></joint>
"#;
    let heavier = Urdf {
        extra: load,
        ..Urdf::default()
    };
    let heavier = Robot::from_urdf_str(&heavier.text()).expect("a description in order");
    let (report, said) = compared(&before, &executed(&heavier, 3));
    let causes = report["causes"].as_array().cloned().unwrap_or_default();
    let loaded = |c: &Value| {
        let joints = c["joints"].as_array().into_iter().flatten();
        c["confirmed"] == true && joints.into_iter().any(|j| j == "reach")
    };
    assert!(causes.iter().any(loaded), "{said}");
}
