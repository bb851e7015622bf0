//! The programs on bags: the same as on a table of the same data, and refusals in one line.

use physics::robot::Robot;
use serde_json::Value;
use std::path::{Path, PathBuf};
use tests::bag::write_bag;
use tests::program::{program, run};
use tests::synthetic::{Plan, record, record_to};

fn joints(robot: &Robot) -> Vec<String> {
    robot.joints().iter().map(|j| j.name.clone()).collect()
}

fn fixture(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    folder.join("../datasets/tests/fixtures/bags").join(name)
}

/// Numbers that agree to 1 in a million (times are whole nanoseconds in a bag), everything else alike.
fn alike(a: &Value, b: &Value, place: &str) {
    match (a, b) {
        (Value::Number(x), Value::Number(y)) => {
            let (x, y) = (x.as_f64().unwrap(), y.as_f64().unwrap());
            assert!(
                (x - y).abs() <= 1e-6 * x.abs().max(1e-3),
                "{place}: {x} and {y}"
            );
        }
        (Value::Array(x), Value::Array(y)) if x.len() == y.len() => {
            for (i, (x, y)) in x.iter().zip(y).enumerate() {
                alike(x, y, &format!("{place}[{i}]"));
            }
        }
        (Value::Object(x), Value::Object(y)) if x.len() == y.len() => {
            for (key, value) in x {
                alike(value, &y[key], &format!("{place}.{key}"));
            }
        }
        _ => assert_eq!(a, b, "{place}"),
    }
}

fn check(data: &Path) -> Value {
    let mut train = program("train");
    train.args(["--robot", "ur5", "--check-only", "--json", "--data"]);
    let ended = run(train.arg(data));
    let mut report: Value = serde_json::from_str(&ended.succeeded().out).expect("JSON");
    report[0]["source"] = Value::Null;
    report
}

#[test]
fn a_bag_is_checked_as_the_table_of_the_same_data() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let robot = Robot::builtin("ur5").expect("built in");
    let plan = Plan::default();
    let table = record_to(folder.path(), "r.csv", &robot, &plan);
    let bag = folder.path().join("r.mcap");
    write_bag(&bag, &record(&robot, &plan), &joints(&robot));
    let (of_table, of_bag) = (check(&table), check(&bag));
    assert_eq!(of_table[0]["trajectories"], 3);
    alike(&of_table, &of_bag, "check");
}

#[test]
fn train_eval_and_diagnose_run_on_bags() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let robot = Robot::builtin("ur5").expect("built in");
    let later = Plan {
        seed: 2,
        ..Plan::default()
    };
    let [data, heldout] = [("a", Plan::default()), ("b", later)].map(|(name, plan)| {
        let bag = folder.path().join(name).with_extension("mcap");
        write_bag(&bag, &record(&robot, &plan), &joints(&robot));
        bag
    });
    let model = folder.path().join("model");
    let mut train = program("train");
    train.args(["--robot", "ur5", "--basic", "--physics-only", "--data"]);
    run(train.arg(&data).arg("--out").arg(&model)).succeeded();
    let text = std::fs::read_to_string(model.join("model.json")).expect("a model");
    let file: Value = serde_json::from_str(&text).expect("JSON");
    let source = &file["provenance"]["recordings"][0];
    assert_eq!(
        source["sha256"].as_str().map(str::len),
        Some(64),
        "{source}"
    );

    let mut eval = program("eval");
    eval.arg("--model").arg(&model).arg("--data").arg(&heldout);
    run(&mut eval).succeeded();
    let mut diagnose = program("diagnose");
    diagnose.args(["--robot", "ur5", "--fast", "--data"]);
    run(diagnose.arg(&data).arg("--heldout").arg(&heldout)).succeeded();
}

#[test]
fn the_list_shows_topics_joints_and_fields() {
    let mut train = program("train");
    let ended = run(train.args(["--list", "--data"]).arg(fixture("zstd.mcap")));
    let out = &ended.succeeded().out;
    for line in [
        "zstd.mcap: 2 topics",
        "/joint_states (sensor_msgs/JointState): 60 messages, 125.5 Hz",
        "joints: shoulder, elbow, gripper",
        "position[], velocity[], effort[]",
        "/chatter (std_msgs/String): 3 messages",
    ] {
        assert!(out.contains(line), "no `{line}` in: {out}");
    }
}

#[test]
fn bags_that_cannot_be_used_are_refused_in_one_line() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let whole = std::fs::read(fixture("zstd.mcap")).expect("a fixture");
    let made = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("a temporary file");
        path
    };
    let mut flipped = whole.clone();
    let chunk = flipped.windows(4).position(|w| w == b"zstd");
    flipped[chunk.expect("a packed chunk") + 60] ^= 1;
    let mut packed = whole.clone();
    for at in 0..packed.len() - 4 {
        if packed[at..].starts_with(b"zstd") {
            packed[at..at + 4].copy_from_slice(b"zstx");
        }
    }
    let cases: [(PathBuf, &[&str]); 6] = [
        (
            made("cut.mcap", &whole[..3000]),
            &["cut.mcap", "ends at byte 3000"],
        ),
        (
            made("flipped.mcap", &flipped),
            &["flipped.mcap", "chunk at byte"],
        ),
        (made("packed.mcap", &packed), &["compression `zstx`"]),
        (made("nothing.mcap", b""), &["ends at byte 0"]),
        (fixture("empty.mcap"), &["has no samples"]),
        (
            fixture("zstd.mcap"),
            &["joint `", "shoulder, elbow, gripper"],
        ),
    ];
    for (path, fragments) in cases {
        let mut train = program("train");
        train.args(["--robot", "ur5", "--check-only", "--data"]);
        run(train.arg(path)).refused(fragments);
    }
    let drive = made("drive.toml", b"[columns]\nq = \"/other\"\n");
    let mut train = program("train");
    train
        .args(["--robot", "ur5", "--check-only", "--drive"])
        .arg(drive);
    run(train.arg("--data").arg(fixture("zstd.mcap"))).refused(&[
        "topic `/other` is missing",
        "/joint_states (sensor_msgs/JointState)",
    ]);
}
