//! Output that nobody reads to its end, and recordings in another unit.

use physics::robot::Robot;
use std::process::{Command, Stdio};
use tests::csv::Csv;
use tests::program::{program, run};
use tests::synthetic::{Plan, record, record_to};

/// Runs a command whose output is closed from the start, as `… | head -0` closes it.
fn unread(command: &mut Command) -> (Option<i32>, String) {
    let mut child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    (
        output.status.code(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
}

#[test]
fn a_closed_pipe_ends_the_output_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let robot = Robot::builtin("ur5").expect("built in");
    let data = record_to(folder.path(), "r.csv", &robot, &Plan::default());
    let model = folder.path().join("model");
    let mut train = program("train");
    train.args(["--robot", "ur5", "--basic", "--physics-only", "--data"]);
    let (status, err) = unread(train.arg(&data).arg("--out").arg(&model));
    assert_eq!(
        (status, err.contains("panicked")),
        (Some(0), false),
        "{err}"
    );
    assert!(model.join("model.json").is_file() && model.join("report.html").is_file());

    let mut check = program("train");
    check.args(["--robot", "ur5", "--check-only", "--data"]);
    let (status, err) = unread(check.arg(&data));
    assert_eq!(
        (status, err.contains("panicked")),
        (Some(0), false),
        "{err}"
    );

    let mut eval = program("eval");
    eval.arg("--model").arg(&model).arg("--data").arg(&data);
    let (status, err) = unread(&mut eval);
    assert_eq!(
        (status, err.contains("panicked")),
        (Some(0), false),
        "{err}"
    );

    let mut diagnose = program("diagnose");
    diagnose.args(["--robot", "ur5", "--data"]).arg(&data);
    let json = folder.path().join("gap.json");
    let other = Plan {
        seed: 2,
        ..Plan::default()
    };
    let heldout = record_to(folder.path(), "other.csv", &robot, &other);
    diagnose
        .arg("--heldout")
        .arg(&heldout)
        .arg("--json")
        .arg(&json);
    let (status, err) = unread(&mut diagnose);
    assert_eq!(
        (status, err.contains("panicked")),
        (Some(0), false),
        "{err}"
    );
    assert!(json.is_file());
}

#[test]
fn degrees_are_refused_with_the_line_that_declares_them() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let robot = Robot::builtin("ur5").expect("built in");
    let radians = record_to(folder.path(), "r.csv", &robot, &Plan::default());
    let mut turned = record(&robot, &Plan::default());
    turned.q.mapv_inplace(f64::to_degrees);
    turned.qd = turned.qd.map(|t| t.mapv(f64::to_degrees));
    turned.qdd = turned.qdd.map(|t| t.mapv(f64::to_degrees));
    let path = folder.path().join("deg.csv");
    Csv::of(&turned).write(&path);
    let expected = ["deg.csv", "in degrees", "units.angle = \"deg\""];
    let out = folder.path().join("out");

    let train = |drive: Option<&std::path::Path>| {
        let mut train = program("train");
        train.args(["--robot", "ur5", "--basic", "--physics-only", "--data"]);
        train.arg(&path).arg("--out").arg(&out);
        if let Some(drive) = drive {
            train.arg("--drive").arg(drive);
        }
        run(&mut train)
    };
    train(None).refused(&expected);
    assert!(!out.exists());
    let mut diagnose = program("diagnose");
    diagnose.args(["--robot", "ur5", "--data"]).arg(&path);
    run(diagnose.arg("--heldout").arg(&radians)).refused(&expected);

    // The line that is named is the cure.
    let drive = folder.path().join("drive.toml");
    std::fs::write(&drive, "units.angle = \"deg\"\n").expect("writable");
    train(Some(&drive)).succeeded();
    let mut eval = program("eval");
    eval.arg("--model").arg(&out).arg("--data").arg(&path);
    run(&mut eval).refused(&expected);
}
