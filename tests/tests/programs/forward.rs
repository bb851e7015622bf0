//! `train forward`: positions from torque, and that what it writes stays with its model.

use physics::robot::Robot;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;
use tests::program::{json, program, row, run};
use tests::synthetic::{Plan, record_to};

/// Short motions of one length.
fn plan(trajectories: usize, seed: u64) -> Plan {
    Plan {
        trajectories,
        seconds: 4.0,
        rate: 25.0,
        seed,
        ..Plan::default()
    }
}

/// A folder with the recording `many.csv` and a model of physics alone that was trained on it.
fn trained() -> (TempDir, PathBuf, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let robot = Robot::builtin("ur5").expect("built in");
    let data = record_to(folder.path(), "many.csv", &robot, &plan(18, 1));
    let model = folder.path().join("model");
    run(&mut train(&data, &model)).succeeded();
    (folder, data, model)
}

fn train(data: &Path, model: &Path) -> Command {
    let mut train = program("train");
    train.args(["--robot", "ur5", "--basic", "--physics-only", "--quiet"]);
    train.arg("--data").arg(data).arg("--out").arg(model);
    train
}

fn forward(data: &Path, model: &Path, more: &[&str]) -> Command {
    let mut forward = program("train");
    forward.arg("forward").arg("--model").arg(model);
    forward.arg("--data").arg(data).args(more);
    forward
}

#[test]
fn taught_scored_and_only_with_its_own_model() {
    let (folder, data, model) = trained();
    let file = model.join("forward.json");
    run(&mut forward(&data, &model, &["--folds", "0", "--quiet"])).succeeded();
    let taught = std::fs::read(&file).expect("written");
    run(&mut forward(
        &data,
        &model,
        &["--folds", "0", "--threads", "1"],
    ))
    .succeeded();
    assert!(
        std::fs::read(&file).expect("written") == taught,
        "the same every time"
    );

    let robot = Robot::builtin("ur5").expect("built in");
    let other = record_to(folder.path(), "other.csv", &robot, &plan(2, 2));
    let scores = folder.path().join("scores.json");
    let eval = |model: &Path| {
        let mut eval = program("eval");
        eval.arg("--model").arg(model).arg("--data").arg(&other);
        run(eval.arg("--json").arg(&scores))
    };
    eval(&model).succeeded();
    let found = row(&json(&scores), "rows", "physics_forward", "all")["mean_nrmse"].as_f64();
    // 1 is what standing at the mean would score.
    assert!(found.is_some_and(|f| f < 0.3), "{found:?}");

    // Beside another model it is refused; a training takes it away.
    let text = std::fs::read_to_string(model.join("model.json")).expect("readable");
    let seed = text.replacen("\"seed\": 0", "\"seed\": 1", 1);
    assert_ne!(seed, text, "the edit changes nothing");
    std::fs::write(model.join("model.json"), seed).expect("writable");
    eval(&model).refused(&["forward.json", "another model", "checksum"]);
    run(&mut train(&data, &model)).succeeded();
    assert!(!file.exists(), "that of an earlier model stays");
    eval(&model).succeeded();
}

#[test]
fn what_cannot_be_learned_from_is_refused() {
    let (folder, data, model) = trained();
    let robot = Robot::builtin("ur5").expect("built in");
    let refused = |data: &Path, model: &Path, more: &[&str], fragments: &[&str]| {
        run(&mut forward(data, model, more)).refused(fragments);
        assert!(
            !model.join("forward.json").exists(),
            "something was written"
        );
    };
    let few = record_to(folder.path(), "few.csv", &robot, &plan(2, 3));
    refused(&few, &model, &[], &["2 trajectories", "at least"]);
    let still = Plan {
        still: vec![3],
        ..plan(18, 1)
    };
    let still = record_to(folder.path(), "still.csv", &robot, &still);
    refused(&still, &model, &[], &["never moves"]);
    refused(&data, &folder.path().join("none"), &[], &["model.json"]);
    refused(&folder.path().join("none.csv"), &model, &[], &["none.csv"]);
    refused(&data, &model, &["--folds", "1"], &["--folds 1"]);
    refused(
        &data,
        &model,
        &["--threads", "0"],
        &["--threads", "from 1 on"],
    );
    let three = folder.path().join("three.csv");
    std::fs::write(&three, "time,q1,tau1\n0,0,0\n0.1,0.1,1\n0.2,0.2,1\n").expect("writable");
    refused(&three, &model, &[], &["three.csv", "joint"]);
}

#[test]
fn interrupted_it_writes_nothing() {
    let (_folder, data, model) = trained();
    let mut child = forward(&data, &model, &["--folds", "18"])
        .stderr(Stdio::null())
        .stdout(Stdio::null())
        .spawn()
        .expect("train starts");
    // Judging eighteen folds takes many seconds; the handler is there from the start.
    std::thread::sleep(Duration::from_millis(500));
    // The shell's own kill: a bare machine has no other.
    let kill = format!("kill -INT {}", child.id());
    run(Command::new("sh").args(["-c", &kill])).succeeded();
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    assert!(!model.join("forward.json").exists(), "half-taught");
}
