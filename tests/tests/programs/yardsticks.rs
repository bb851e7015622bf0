//! `train --yardsticks`: ridge regression and, where the programs were built with them (feature `trees` of both), boosted trees beside the
//! networks, which stay what is exported.

use physics::robot::Robot;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use tests::program::{json, program, row, run};
use tests::synthetic::{Plan, record_to};

/// Whether the programs grow trees.
const TREES: bool = cfg!(feature = "trees");

struct Place {
    folder: tempfile::TempDir,
    data: PathBuf,
    test: PathBuf,
}

impl Place {
    fn new(trajectories: usize) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let robot = Robot::builtin("ur5").expect("built in");
        let record = |name: &str, seed| {
            let plan = Plan {
                seed,
                trajectories,
                seconds: 3.0,
                ..Plan::default()
            };
            record_to(folder.path(), name, &robot, &plan)
        };
        let (data, test) = (record("train.csv", 1), record("test.csv", 2));
        Self { folder, data, test }
    }

    fn train(&self, out: &str, more: &[&str]) -> (PathBuf, Command) {
        let out = self.folder.path().join(out);
        let mut train = program("train");
        train.args(["--robot", "ur5", "--basic", "--epochs", "2", "--members"]);
        train.arg("1").arg("--data").arg(&self.data);
        train.arg("--heldout").arg(&self.test);
        train.arg("--out").arg(&out).args(more);
        (out, train)
    }
}

fn files(model: &Path) -> [PathBuf; 2] {
    ["yardsticks.json", "yardsticks.safetensors"].map(|name| model.join(name))
}

fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).expect("a file")
}

#[test]
fn beside_the_networks_and_no_part_of_them() {
    let place = Place::new(5);
    let (model, mut train) = place.train("model", &["--yardsticks"]);
    let printed = run(&mut train).succeeded().out.clone();
    for part in [
        "Yardsticks",
        "last epoch",
        "trees",
        "physics+ridge on the held-out",
    ] {
        assert!(printed.contains(part), "no `{part}` in {printed}");
    }
    let [figures, _] = files(&model);
    let held = json(&figures)["held_back"].clone();
    let held = held.as_array().expect("joints");
    assert_eq!(held.len(), 6);
    for joint in held {
        for key in ["physics", "unit", "unit_at_last_epoch", "ridge"] {
            assert!(
                joint[key].as_f64().is_some_and(|v| v > 0.0),
                "{key} {joint}"
            );
        }
        let grown = joint["tree_count"].as_u64().expect("a number") > 0;
        assert_eq!(grown, TREES, "{joint}");
        assert_eq!(joint["trees"].as_f64().is_some_and(|v| v > 0.0), TREES);
    }

    // The leaderboard has the figures of the training, and no running time of what does not run.
    let metrics = json(&model.join("metrics.json"));
    let board = board(&place, &model);
    let trees = board.iter().any(|r| r["model"] == "physics+trees");
    assert_eq!(trees, TREES);
    let names = ["physics+ridge", "physics+trees"];
    for name in &names[..1 + usize::from(TREES)] {
        let entry = board.iter().find(|r| r["model"] == *name);
        let entry = entry.unwrap_or_else(|| panic!("no {name} in {board:?}"));
        for scope in ["all", "moving"] {
            let own = row(&metrics, "heldout", name, scope);
            let pair = [own, &entry[scope]].map(|of| of["mean_nrmse"].as_f64().expect("a figure"));
            assert!((pair[0] - pair[1]).abs() < 1e-9, "{name} {scope} {pair:?}");
        }
        assert!(entry["inference_us"].is_null(), "{entry}");
    }

    // Same seed, same bytes; and the network is the same without them.
    let (again, mut train) = place.train("again", &["--yardsticks", "--threads", "1", "--quiet"]);
    run(&mut train).succeeded();
    for (a, b) in files(&model).iter().zip(&files(&again)) {
        assert_eq!(bytes(a), bytes(b), "{}", a.display());
    }
    let (again, mut train) = place.train("again", &["--quiet"]);
    run(&mut train).succeeded();
    let network = "compensator.safetensors";
    assert_eq!(bytes(&model.join(network)), bytes(&again.join(network)));
    assert!(files(&again).iter().all(|f| !f.exists()), "left behind");
    let board = self::board(&place, &again);
    assert!(board.iter().all(|r| r["model"] != "physics+ridge"));

    // A damaged file is told, and which.
    std::fs::write(&figures, "{}").expect("writable");
    run(&mut leaderboard(&place, &model)).refused(&["yardsticks.json"]);
}

fn leaderboard(place: &Place, model: &Path) -> Command {
    let mut eval = program("eval");
    eval.arg("--leaderboard").arg(model);
    eval.arg("--data").arg(&place.test);
    eval.arg("--json")
        .arg(place.folder.path().join("board.json"));
    eval
}

fn board(place: &Place, model: &Path) -> Vec<Value> {
    run(&mut leaderboard(place, model)).succeeded();
    let board = json(&place.folder.path().join("board.json"));
    board["rows"].as_array().expect("rows").clone()
}

#[test]
fn too_few_groups_are_refused_before_anything_is_trained() {
    let place = Place::new(2);
    let (model, mut train) = place.train("model", &["--yardsticks"]);
    run(&mut train).refused(&["yardsticks", "three folds"]);
    assert!(!model.join("model.json").exists());
    let (_, mut train) = place.train("model", &["--yardsticks", "--physics-only"]);
    run(&mut train).refused(&["--yardsticks", "--physics-only"]);
}
