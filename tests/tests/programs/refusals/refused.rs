//! What is tried, and that nothing comes of it.

use physics::robot::Robot;
use std::path::Path;
use std::sync::OnceLock;
use tempfile::TempDir;
use tests::csv::Csv;
use tests::program::{program, run};
use tests::synthetic::{Plan, record, record_to};

pub fn ur5() -> Robot {
    Robot::builtin("ur5").expect("built in")
}

/// Two short trajectories of the UR5.
pub fn recording() -> Csv {
    let plan = Plan {
        trajectories: 2,
        seconds: 3.0,
        ..Plan::default()
    };
    Csv::of(&record(&ur5(), &plan))
}

pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// A trained model directory with a compensator, made once.
pub fn model() -> &'static Path {
    static MODEL: OnceLock<TempDir> = OnceLock::new();
    MODEL
        .get_or_init(|| {
            let folder = folder();
            let data = record_to(folder.path(), "r.csv", &ur5(), &Plan::default());
            let mut train = program("train");
            train.args(["--robot", "ur5", "--basic", "--quiet", "--epochs", "2"]);
            train.args(["--members", "1", "--data"]).arg(&data);
            run(train.arg("--out").arg(folder.path().join("model"))).succeeded();
            folder
        })
        .path()
}

/// `train` refuses `data`, into a folder that is not there and into one that is.
#[track_caller]
pub fn train_refuses(data: &Path, extra: &[&str], fragments: &[&str]) {
    let place = folder();
    let (absent, present) = (place.path().join("absent"), place.path().join("present"));
    std::fs::create_dir(&present).expect("a folder");
    std::fs::write(present.join("kept"), "as it was").expect("writable");
    for out in [&absent, &present] {
        let mut train = program("train");
        if !extra.contains(&"--robot") {
            train.args(["--robot", "ur5"]);
        }
        train.arg("--data").arg(data).arg("--out").arg(out);
        run(train.args(extra)).refused(fragments);
    }
    assert!(!absent.exists(), "something was written");
    let left = tests::program::files(&present);
    assert_eq!(left, [("kept".to_owned(), b"as it was".to_vec())]);
    let entries = std::fs::read_dir(&present).expect("it is there").count();
    assert_eq!(entries, 1, "something was written");
}

/// `eval` refuses `data` and writes none of its files.
#[track_caller]
pub fn eval_refuses(model: &Path, data: &Path, fragments: &[&str]) {
    let place = folder();
    let out = |name: &str| place.path().join(name);
    let mut eval = program("eval");
    eval.arg("--model").arg(model).arg("--data").arg(data);
    eval.arg("--json").arg(out("scores.json"));
    eval.arg("--html").arg(out("page.html"));
    run(&mut eval).refused(fragments);
    run(eval.arg("--predict").arg(out("torque.csv"))).refused(fragments);
    assert_eq!(tests::program::files(place.path()), []);
}

/// Both programs refuse `content` in a file of that name, naming the file.
#[track_caller]
pub fn both_refuse(name: &str, content: impl AsRef<[u8]>, fragments: &[&str]) {
    let place = folder();
    let data = place.path().join(name);
    std::fs::write(&data, content).expect("writable");
    let all = [&[name], fragments].concat();
    train_refuses(&data, &["--physics-only"], &all);
    train_refuses(&data, &[], &all);
    eval_refuses(&model().join("model"), &data, &all);
}
