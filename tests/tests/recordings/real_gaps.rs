//! What `diagnose` says of real robots, from the shared data. Nothing of the held-out recordings chooses anything.

use serde_json::Value;
use std::path::Path;
use tests::program::{json, program, run};
use tests::shared::shared;

fn causes(report: &Value) -> Vec<(&str, Vec<&str>)> {
    let list = report["causes"].as_array().expect("a list of causes");
    list.iter()
        .map(|c| {
            let joints = c["joints"].as_array().expect("a list of joints");
            let joints = joints.iter().filter_map(Value::as_str).collect();
            (c["effect"].as_str().expect("a name"), joints)
        })
        .collect()
}

fn joints_of<'a>(causes: &[(&str, Vec<&'a str>)], effect: &str) -> Vec<&'a str> {
    let mut joints: Vec<&str> = causes
        .iter()
        .filter(|(name, _)| *name == effect)
        .flat_map(|(_, joints)| joints.clone())
        .collect();
    joints.sort_unstable();
    joints.dedup();
    joints
}

#[track_caller]
fn absent(causes: &[(&str, Vec<&str>)], effects: &[&str]) {
    for effect in effects {
        let joints = joints_of(causes, effect);
        assert!(joints.is_empty(), "{effect} on {joints:?}");
    }
}

/// A KR300 against a URDF without counterbalance, rotor inertia or friction, and with a guessed payload.
#[test]
#[ignore = "long: .ci/release"]
fn counterbalance_memory_and_warm_up_of_a_kr300() {
    let Some(data) = shared("data/kr300") else {
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("report.json");
    let mut diagnose = program("diagnose");
    diagnose.arg("--robot").arg(data.join("robot.urdf"));
    diagnose.arg("--data").arg(data.join("train.parquet"));
    diagnose.arg("--heldout").arg(data.join("test.parquet"));
    // Surrogates of 36 trajectories of a minute change nothing of what is asserted here, and double its time.
    run(diagnose.arg("--fast").arg("--json").arg(&out)).succeeded();
    let report = json(&out);
    let found = causes(&report);
    println!("{found:?}");
    assert_eq!(joints_of(&found, "counterbalance"), ["joint_2"]);
    let list = report["causes"].as_array().expect("a list of causes");
    let counterbalance = list.iter().find(|c| c["effect"] == "counterbalance");
    let closed = &counterbalance.expect("found above")["gap_closed"];
    // Over all samples, standstill included, which is harder than in motion.
    assert!(closed.as_f64() >= Some(0.9), "{closed} of the gap closed");
    let presliding = joints_of(&found, "presliding_hysteresis");
    for joint in ["joint_4", "joint_5", "joint_6"] {
        assert!(presliding.contains(&joint), "presliding on {presliding:?}");
    }
    let drift = joints_of(&found, "friction_drift");
    assert!(drift.contains(&"joint_1"), "drift on {drift:?}");
    absent(&found, &["external_contact", "time_delay", "torque_ripple"]);
}

fn ur10e_model(data: &Path, out: &Path) {
    let mut train = program("train");
    train.args(["--physics-only", "--quiet"]);
    train.arg("--robot").arg(data.join("robot.urdf"));
    train.arg("--data");
    for name in ["20_02_12-50sec_12harm", "20_02_19_14harm50sec"] {
        train.arg(data.join(name).with_extension("csv"));
    }
    run(train.arg("--out").arg(out)).succeeded();
}

/// A UR10e that carries nothing and touches nothing, against a model identified on other days.
#[test]
fn nothing_is_blamed_on_an_unloaded_ur10e() {
    let Some(data) = shared("data/ur10e") else {
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = folder.path().join("model");
    ur10e_model(&data, &model);
    let out = folder.path().join("report.json");
    let mut diagnose = program("diagnose");
    diagnose.arg("--model").arg(&model);
    diagnose
        .arg("--data")
        .arg(data.join("20_02_19_15harm50sec.csv"));
    diagnose
        .arg("--heldout")
        .arg(data.join("20_02_10-30sec_12harm.csv"));
    run(diagnose.arg("--json").arg(&out)).succeeded();
    let report = json(&out);
    let found = causes(&report);
    println!("{}: {found:?}", report["verdict"]);
    absent(
        &found,
        &[
            "payload",
            "base_tilt",
            "torque_gain",
            "joint_coupling",
            "external_contact",
        ],
    );
}
