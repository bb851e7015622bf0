//! Ctrl-C while the compensator trains, and going on from there; the same bytes on any number of threads.

use physics::robot::Robot;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tests::program::{files, json, program, run};
use tests::synthetic::{Plan, record_to};

fn recording(folder: &Path) -> PathBuf {
    let robot = Robot::builtin("ur5").expect("built in");
    record_to(folder, "recording.csv", &robot, &Plan::default())
}

fn train(recording: &Path, out: &Path, threads: &str) -> Command {
    let mut command = program("train");
    command.args(["--robot", "ur5", "--basic", "--quiet"]);
    command.args(["--epochs", "12", "--members", "1", "--threads", threads]);
    command.arg("--data").arg(recording).arg("--out").arg(out);
    command
}

/// Every file of a model directory but what the training took, which is never the same twice.
fn same_every_time(out: &Path) -> Vec<(String, Vec<u8>)> {
    let (timing, rest): (Vec<_>, Vec<_>) =
        files(out).into_iter().partition(|f| f.0 == "timing.json");
    assert_eq!(timing.len(), 1, "no timing.json");
    rest
}

/// Waits until a network has a checkpoint.
fn training_has_begun(out: &Path) -> bool {
    let folder = out.join("checkpoint/validation");
    std::fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some())
}

#[test]
fn interrupted_and_resumed_equals_uninterrupted() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let data = recording(folder.path());
    let (whole, stopped) = (folder.path().join("whole"), folder.path().join("stopped"));
    run(&mut train(&data, &whole, "2")).succeeded();

    let mut child = train(&data, &stopped, "2")
        .stderr(Stdio::piped())
        .spawn()
        .expect("train starts");
    let patience = Instant::now();
    while !training_has_begun(&stopped) {
        assert!(
            patience.elapsed() < Duration::from_secs(300),
            "no checkpoint"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
    // The shell's own kill: a bare machine has no other.
    let kill = run(Command::new("sh").args(["-c", &format!("kill -INT {}", child.id())]));
    kill.succeeded();
    let status = child.wait().expect("train ends");
    assert_eq!(status.code(), Some(130), "interrupted in the middle");
    assert!(!stopped.join("model.json").exists(), "half-written model");

    // Other arguments cannot go on from it, and do not spoil it.
    run(train(&data, &stopped, "2").args(["--resume", "--seed", "7"])).refused(&[
        "--resume with other arguments",
        "seed 0",
        "seed 7",
    ]);
    run(train(&data, &stopped, "1").arg("--resume")).succeeded();
    assert!(!stopped.join("checkpoint").exists());
    let resumed = |out: &Path| json(&out.join("timing.json"))["resumed"].as_bool();
    assert_eq!(
        (resumed(&whole), resumed(&stopped)),
        (Some(false), Some(true))
    );
    let (one, two) = (same_every_time(&whole), same_every_time(&stopped));
    let names = |list: &[(String, Vec<u8>)]| list.iter().map(|f| f.0.clone()).collect::<Vec<_>>();
    assert_eq!(names(&one), names(&two));
    assert!(names(&one).contains(&"compensator.safetensors".to_owned()));
    for ((name, a), (_, b)) in one.iter().zip(&two) {
        assert!(a == b, "{name} differs from that of an uninterrupted run");
    }

    // Another number of threads, and another seed.
    let again = folder.path().join("again");
    run(&mut train(&data, &again, "1")).succeeded();
    assert!(
        same_every_time(&again) == one,
        "the result depends on the number of threads"
    );
    let other = folder.path().join("other");
    run(train(&data, &other, "2").args(["--seed", "1"])).succeeded();
    let weights = |folder: &Path| std::fs::read(folder.join("compensator.safetensors")).ok();
    assert!(
        weights(&other) != weights(&whole),
        "the seed changes nothing"
    );
}

#[test]
fn resuming_needs_a_checkpoint() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let data = recording(folder.path());
    let out = folder.path().join("out");
    run(train(&data, &out, "1").arg("--resume")).refused(&["holds no checkpoint to resume"]);
    assert!(!out.exists(), "nothing is written");
}
