//! The torque channel's doctor: every fault on a simulated recording, its remedy, and a user's way with a file.

use datasets::write;
use physics::robot::{PARAMETERS_PER_LINK, Robot};
use serde_json::Value;
use std::path::{Path, PathBuf};
use tests::program::{json, program, run};
use tests::shared::shared;
use tests::synthetic::{Plan, record};

/// One recording of each kind; `train doctor` with more of them, on other seeds, prints the table of docs/torque-channel.md.
#[test]
fn every_fault_is_named_and_mended() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("doctor.json");
    let mut doctor = program("train");
    doctor.args(["doctor", "--cases", "1", "--healthy", "1", "--seed", "611"]);
    doctor.args(["--wrong-descriptions", "1"]);
    run(doctor.args(["--quiet", "--json"]).arg(&file)).succeeded();
    let figures = json(&file);
    assert_eq!(figures["schema"], "doctor/1");
    let kinds = figures["kinds"].as_array().expect("kinds");
    assert_eq!(kinds.len(), 18);
    for kind in kinds {
        let outcomes = kind["outcomes"].as_array().expect("outcomes");
        for outcome in outcomes {
            assert_eq!(outcome["right"], true, "{}: {outcome}", kind["fault"]);
            assert_ne!(outcome["mended"], false, "{}: {outcome}", kind["fault"]);
        }
    }
}

/// Recordings of real arms: link torque from motor currents, from sensors at the joints (Panda), or low-passed before it was
/// stored (UR10). The UR10e's fifth joint carries so little that its described torque is no measure of a scale.
#[test]
fn no_real_channel_is_accused() {
    let ur10e = [
        "10-30sec_12harm",
        "12-50sec_12harm",
        "19_14harm50sec",
        "19_15harm50sec",
    ]
    .map(|name| (format!("ur10e/20_02_{name}.csv"), "ur10e", ""));
    let others = [
        ("panda", "joint_sensor"),
        ("ur10", "filtered"),
        ("xmate", ""),
    ]
    .map(|(arm, may)| (format!("{arm}/train.csv"), arm, may));
    let kr300 = [("kr300/test.parquet".to_owned(), "kr300", "")];
    for (file, arm, may) in ur10e.into_iter().chain(others).chain(kr300) {
        let Some(data) = shared(&format!("data/{file}")) else {
            continue;
        };
        let robot = match arm {
            "kr300" => arm.into(),
            _ => data.with_file_name("robot.urdf"),
        };
        let mut train = program("train");
        train.args(["--check-only", "--json", "--robot"]).arg(robot);
        let ended = run(train.arg("--data").arg(data));
        let found: Value = serde_json::from_str(&ended.succeeded().out).expect("JSON");
        for complaint in found[0]["doctor"].as_array().expect("a list") {
            assert_eq!(complaint["ailment"], may, "{file}: {complaint:#}");
            assert_eq!(complaint["severity"], "note", "{file}: {complaint:#}");
        }
    }
}

#[test]
fn torque_of_the_motors_is_named_and_the_line_given_mends_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let robot = Robot::builtin("ur5").expect("built in");
    let mut recording = record(&robot, &Plan::default());
    let tau = recording.tau.as_mut().expect("torque");
    tau.mapv_inplace(|t| t / 101.0);
    // The third joint's sign is turned as well.
    tau.column_mut(2).mapv_inplace(|t| -t);
    let data = folder.path().join("motors.csv");
    write(&recording, &data).expect("a file");
    let checked = |more: &[&str]| -> Value {
        let mut train = program("train");
        train.args(["--robot", "ur5", "--check-only", "--json", "--data"]);
        let ended = run(train.arg(&data).args(more));
        serde_json::from_str(&ended.succeeded().out).expect("JSON")
    };
    let found = checked(&[]);
    let complaints = found[0]["doctor"].as_array().expect("a list");
    let named = |name: &str| complaints.iter().find(|c| c["ailment"] == name);
    let motor = named("motor").unwrap_or_else(|| panic!("{complaints:#?}"));
    let sign = named("sign").unwrap_or_else(|| panic!("{complaints:#?}"));
    assert_eq!(sign["joints"], serde_json::json!([2]));
    for part in ["seen", "means", "advice"] {
        assert!(!motor[part].as_str().expect("text").is_empty());
    }
    let lines = |c: &Value| c["drive"].as_str().expect("lines").to_owned();
    // `units` is a table of its own: lines of the top come first.
    let drive = folder.path().join("drive.toml");
    std::fs::write(&drive, format!("{}\n{}\n", lines(sign), lines(motor))).expect("written");
    let mended = checked(&["--drive", &drive.to_string_lossy()]);
    let severe = |c: &&Value| c["severity"] != "note";
    let left: Vec<&Value> = mended[0]["doctor"]
        .as_array()
        .expect("a list")
        .iter()
        .filter(severe)
        .collect();
    assert!(left.is_empty(), "{left:#?}");
    // The words that a person reads.
    let mut train = program("train");
    train.args(["--robot", "ur5", "--check-only", "--data"]);
    let screen = run(train.arg(&data)).succeeded().out.clone();
    for part in [
        "torque, motor:",
        "torque, sign:",
        "drive file (--drive FILE.toml):",
        "units.torque = \"motor\"",
    ] {
        assert!(screen.contains(part), "no `{part}` in {screen}");
    }
}

/// Motion enough to tell masses by.
fn long() -> Plan {
    Plan {
        seconds: 12.0,
        ..Plan::default()
    }
}

/// Writes a robot's description into a folder.
fn urdf(folder: &Path, robot: &Robot) -> PathBuf {
    let path = folder.join("described.urdf");
    std::fs::write(&path, physics::robot::to_urdf(robot)).expect("writable");
    path
}

/// Names and contents of what is said of a torque, notes aside.
fn said(urdf: &Path, data: &Path) -> Vec<(String, Value)> {
    let mut train = program("train");
    train.args(["--check-only", "--json", "--robot"]).arg(urdf);
    let ended = run(train.arg("--data").arg(data));
    let found: Value = serde_json::from_str(&ended.succeeded().out).expect("JSON");
    let all = found[0]["doctor"].as_array().expect("complaints");
    all.iter()
        .filter(|c| c["severity"] != "note")
        .map(|c| (c["ailment"].as_str().expect("a name").to_owned(), c.clone()))
        .collect()
}

/// Recordings of true torque against descriptions that are not the robot's: no fault of the channel is said alone, and no factor is there
/// to paste where masses explain it as well.
#[test]
fn a_wrong_description_is_no_unit() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let robot = Robot::builtin("ur5").expect("built in");
    let data = folder.path().join("run.parquet");
    write(&record(&robot, &long()), &data).expect("writable");
    let scaled = |factor: &dyn Fn(usize) -> f64| {
        let mut parameters = robot.parameters();
        for (link, own) in parameters.chunks_mut(PARAMETERS_PER_LINK).enumerate() {
            own.iter_mut().for_each(|p| *p *= factor(link));
        }
        robot.with_parameters(&parameters).expect("ten a link")
    };
    type Factor<'a> = &'a dyn Fn(usize) -> f64;
    let heavy: [Factor; 4] = [&|_| 1.5, &|_| 1.8, &|_| 2.0, &|k| 1.4 + 0.12 * k as f64];
    for factor in heavy {
        let path = urdf(folder.path(), &scaled(factor));
        let found = said(&path, &data);
        let description = found.iter().find(|(name, _)| name == "description");
        let (_, description) = description.unwrap_or_else(|| panic!("{found:?}"));
        assert!(found.iter().all(|(_, c)| c["drive"].is_null()), "{found:?}");
        // The first link turns about the vertical with its rotor beside it: its mass shows nowhere, and no factor is said of it.
        let seen = description["seen"].as_str().expect("text");
        assert!(!seen.contains("shoulder_link"), "{seen}");
    }
}

/// Columns of two joints exchanged, in position, velocity and torque.
#[test]
fn exchanged_columns_are_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let robot = Robot::builtin("ur5").expect("built in");
    let recorded = record(&robot, &long());
    let right = urdf(folder.path(), &robot);
    for (a, b) in [(0, 1), (1, 2), (1, 3), (2, 3)] {
        let mut order: Vec<usize> = (0..6).collect();
        order.swap(a, b);
        let mut turned = recorded.clone();
        turned.q = turned.q.select(ndarray::Axis(1), &order);
        for table in [&mut turned.tau, &mut turned.qd, &mut turned.qdd]
            .into_iter()
            .flatten()
        {
            *table = table.select(ndarray::Axis(1), &order);
        }
        let path = folder.path().join("exchanged.parquet");
        write(&turned, &path).expect("writable");
        let found = said(&right, &path);
        let named = found.iter().find(|(name, _)| name == "columns");
        let joints = named.map(|(_, c)| c["joints"].clone());
        assert_eq!(joints, Some(serde_json::json!([a, b])), "{found:?}");
    }
}
