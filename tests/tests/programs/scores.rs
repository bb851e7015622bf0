//! Scores and predictions of `eval`, and recordings that say little.

use physics::robot::Robot;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use tests::csv::Csv;
use tests::program::{files, json, mean_nrmse, program, row, run};
use tests::shared::shared;
use tests::synthetic::{Plan, record, record_to};

fn ur5() -> Robot {
    Robot::builtin("ur5").expect("built in")
}

/// Trains on `data` into `folder`/model, basic terms and a short compensator.
fn train(folder: &Path, data: &Path, extra: &[&str]) -> PathBuf {
    let out = folder.join("model");
    let mut train = program("train");
    train.args(["--robot", "ur5", "--basic", "--quiet"]);
    train.args(["--epochs", "4", "--members", "1"]);
    train.arg("--data").arg(data).arg("--out").arg(&out);
    run(train.args(extra)).succeeded();
    out
}

fn eval(model: &Path, data: &Path) -> Command {
    let mut eval = program("eval");
    eval.arg("--model").arg(model).arg("--data").arg(data);
    eval
}

#[test]
fn scores_and_predictions() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| folder.path().join(name);
    let data = record_to(folder.path(), "train.csv", &ur5(), &Plan::default());
    let other = Plan {
        seed: 2,
        ..Plan::default()
    };
    let test = record_to(folder.path(), "test.csv", &ur5(), &other);
    let held = ["--heldout", test.to_str().expect("a name in UTF-8")];
    let model = train(folder.path(), &data, &held);
    let names: Vec<String> = files(&model).into_iter().map(|f| f.0).collect();
    for name in ["model.json", "metrics.json", "compensator.safetensors"] {
        assert!(names.iter().any(|n| n == name), "{name} among {names:?}");
    }
    // The directory stands alone.
    let moved = place("moved");
    std::fs::rename(&model, &moved).expect("movable");
    std::fs::remove_file(&data).expect("removable");

    let ended = run(eval(&moved, &test)
        .arg("--json")
        .arg(place("scores.json"))
        .arg("--html")
        .arg(place("page.html"))
        .arg("--predict")
        .arg(place("torque.csv")));
    ended.succeeded();
    for name in ["linear_baseline", "physics", "physics+compensator"] {
        assert!(ended.out.contains(name), "no {name} in {}", ended.out);
    }
    let scores = json(&place("scores.json"));
    assert_eq!(scores["schema"], "eval/1");
    assert_eq!(scores["samples"], 1503);
    // What train said of the held-out recording is what eval says.
    let metrics = json(&moved.join("metrics.json"));
    for name in ["linear_baseline", "physics", "physics+compensator"] {
        for scope in ["all", "moving"] {
            let (a, b) = (
                mean_nrmse(&scores, "rows", name, scope),
                mean_nrmse(&metrics, "heldout", name, scope),
            );
            assert!((a - b).abs() < 1e-9 * b, "{name}, {scope}: {a} and {b}");
        }
    }
    let page = std::fs::read_to_string(place("page.html")).expect("a page");
    assert!(page.contains("<svg") && page.contains("physics+compensator"));

    let predicted = std::fs::read_to_string(place("torque.csv")).expect("a prediction");
    let header = predicted.lines().next().unwrap_or_default();
    assert!(header.starts_with("trajectory,time,tau1,tau2,tau3,tau4,tau5,tau6"));
    rmse_is_that_of_the_prediction(&scores, &test, &predicted);

    // Without torque: the same prediction, no scores.
    let bare = place("bare.csv");
    let torque = ["tau1", "tau2", "tau3", "tau4", "tau5", "tau6"];
    Csv::of(&record(&ur5(), &other))
        .without(&torque)
        .write(&bare);
    run(eval(&moved, &bare)
        .arg("--predict")
        .arg(place("bare-torque.csv")))
    .succeeded();
    let again = std::fs::read_to_string(place("bare-torque.csv")).expect("a prediction");
    assert_eq!(again, predicted);

    if let Some(checker) = shared("tools/check_contract.py") {
        run(Command::new("python3")
            .arg(checker)
            .arg(place("scores.json")))
        .succeeded();
    }
}

/// A model of another robot, or of joints in another order, is said not to fit; one of the recorded robot is not.
#[test]
fn a_model_that_does_not_fit_is_said() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let data = record_to(folder.path(), "train.csv", &ur5(), &Plan::default());
    let model = train(folder.path(), &data, &["--physics-only"]);
    let other = Plan {
        seed: 2,
        ..Plan::default()
    };
    let own = record_to(folder.path(), "own.csv", &ur5(), &other);
    let foxbot = Robot::builtin("foxbot_a05").expect("built in");
    let wrong = record_to(folder.path(), "wrong.csv", &foxbot, &other);
    let swapped = folder.path().join("swapped.csv");
    let text = std::fs::read_to_string(&own).expect("a recording");
    let (head, rows) = text.split_once('\n').expect("a header");
    let turned = head.replace("tau1", "?").replace("tau4", "tau1");
    let turned = turned.replace('?', "tau4");
    std::fs::write(&swapped, format!("{turned}\n{rows}")).expect("writable");
    let scores = folder.path().join("scores.json");
    for (data, fits) in [(&own, true), (&wrong, false), (&swapped, false)] {
        let ended = run(eval(&model, data).arg("--json").arg(&scores));
        ended.succeeded();
        let notes = json(&scores)["notes"].to_string();
        for said in [&ended.out, &notes] {
            assert_eq!(
                !said.contains("does not fit this recording"),
                fits,
                "{data:?}: {said}"
            );
        }
        assert!(fits || ended.out.contains("NRMSE "), "{}", ended.out);
    }
}

/// Earlier versions kept the covariance in `model.json` itself; what a control loop reads is smaller without it.
#[test]
fn a_directory_of_an_earlier_version_predicts_the_same() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let data = record_to(folder.path(), "train.csv", &ur5(), &Plan::default());
    let model = train(folder.path(), &data, &["--physics-only"]);
    let predicted = || {
        let to = folder.path().join("torque.csv");
        run(eval(&model, &data).arg("--predict").arg(&to)).succeeded();
        std::fs::read_to_string(to).expect("a prediction")
    };
    let now = predicted();
    let (whole, apart) = (model.join("model.json"), model.join("covariance.json"));
    let mut file = json(&whole);
    let keys = file.as_object_mut().expect("an object");
    assert!(!keys.contains_key("covariance"));
    keys.remove("covariance_sha256")
        .expect("ties the two together");
    keys.insert("covariance".into(), json(&apart)["covariance"].take());
    std::fs::write(&whole, file.to_string()).expect("writable");
    std::fs::remove_file(&apart).expect("removable");
    assert_eq!(predicted(), now);
}

/// `eval` prepares a recording as the model was prepared, whatever the rate: the figures of `train --heldout`, to the
/// last digit.
#[test]
fn eval_repeats_what_train_said_at_every_rate() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for rate in [50.0, 100.0, 125.0, 250.0, 1000.0] {
        let plan = |seed| Plan {
            rate,
            seed,
            trajectories: 2,
            ..Plan::default()
        };
        let data = record_to(folder.path(), "train.csv", &ur5(), &plan(1));
        let test = record_to(folder.path(), "test.csv", &ur5(), &plan(2));
        let held = ["--physics-only", "--heldout", test.to_str().expect("UTF-8")];
        let model = train(folder.path(), &data, &held);
        let scores = folder.path().join("scores.json");
        run(eval(&model, &test).arg("--json").arg(&scores)).succeeded();
        let (scores, metrics) = (json(&scores), json(&model.join("metrics.json")));
        for name in ["linear_baseline", "physics"] {
            for scope in ["all", "moving"] {
                assert_eq!(
                    row(&scores, "rows", name, scope),
                    row(&metrics, "heldout", name, scope),
                    "{rate} Hz, {name}, {scope}"
                );
            }
        }
        let cutoff = json(&model.join("model.json"))["preprocessing"]["cutoff_hz"].as_f64();
        assert!(
            cutoff.is_some_and(|hz| hz <= 0.4 * rate),
            "{rate} Hz: {cutoff:?}"
        );
    }
}

/// A recording whose rate cannot carry the model's cut-off takes the highest that it can, and that is said.
#[test]
fn a_slower_recording_takes_what_its_rate_carries() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let plan = |rate, seed| Plan {
        rate,
        seed,
        ..Plan::default()
    };
    let data = record_to(folder.path(), "train.csv", &ur5(), &plan(250.0, 1));
    let slow = record_to(folder.path(), "slow.csv", &ur5(), &plan(50.0, 2));
    let model = train(
        folder.path(),
        &data,
        &["--physics-only", "--cutoff-hz", "30"],
    );
    let ended = run(&mut eval(&model, &slow));
    ended.succeeded();
    assert!(
        ended
            .out
            .contains("low-pass at 20.000 Hz, the highest that this rate carries"),
        "{}",
        ended.out
    );
}

/// The scores are those of what --predict writes, against the torque as it stands in the file.
fn rmse_is_that_of_the_prediction(scores: &Value, recording: &Path, predicted: &str) {
    let table = |text: &str| -> Vec<Vec<f64>> {
        let mut lines = text.lines().map(|line| line.split(','));
        let header: Vec<&str> = lines.next().map(Iterator::collect).unwrap_or_default();
        let places: Vec<usize> = (1..=6)
            .filter_map(|j| header.iter().position(|h| *h == format!("tau{j}")))
            .collect();
        lines
            .map(|cells| {
                let cells: Vec<&str> = cells.collect();
                let number = |&p: &usize| cells[p].parse().expect("a number");
                places.iter().map(number).collect()
            })
            .collect()
    };
    let measured = table(&std::fs::read_to_string(recording).expect("readable"));
    let predicted = table(predicted);
    assert_eq!(measured.len(), predicted.len());
    let stated = &row(scores, "rows", "physics+compensator", "all")["rmse"];
    for joint in 0..6 {
        let sum: f64 = std::iter::zip(&measured, &predicted)
            .map(|(m, p)| (m[joint] - p[joint]).powi(2))
            .sum();
        let rmse = (sum / measured.len() as f64).sqrt();
        let stated = stated[joint].as_f64().expect("a number");
        assert!((rmse - stated).abs() < 1e-9 * stated, "{rmse} {stated}");
    }
}

#[test]
fn a_joint_that_never_moves() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let plan = Plan {
        still: vec![2],
        ..Plan::default()
    };
    let data = record_to(folder.path(), "still.csv", &ur5(), &plan);
    let check = run(program("train")
        .args(["--robot", "ur5", "--check-only", "--json", "--data"])
        .arg(&data)
        .current_dir(folder.path()));
    check.succeeded();
    let report: Value = serde_json::from_str(&check.out).expect("JSON alone");
    let findings = report[0]["findings"].as_array().expect("findings");
    assert!(
        findings
            .iter()
            .any(|f| f["kind"] == "never_moves" && f["joint"] == 2),
        "{findings:?}"
    );
    assert_eq!(files(folder.path()).len(), 1, "--check-only writes nothing");

    let model = train(folder.path(), &data, &[]);
    let out = folder.path().join("scores.json");
    run(eval(&model, &data).arg("--json").arg(&out)).succeeded();
    let scores = json(&out);
    for name in ["physics", "physics+compensator"] {
        for scope in ["all", "moving"] {
            let row = row(&scores, "rows", name, scope);
            for joint in 0..6 {
                let nrmse = row["nrmse"][joint].as_f64();
                if joint == 2 {
                    assert_eq!(nrmse, None, "{name}, {scope}");
                } else {
                    // Noise and ripple are about a twentieth of the torque.
                    let nrmse = nrmse.expect("a figure");
                    assert!(nrmse < 0.15, "{name}, {scope}, joint {joint}: {nrmse}");
                }
            }
        }
    }
    if let Some(checker) = shared("tools/check_contract.py") {
        run(Command::new("python3").arg(checker).arg(&out)).succeeded();
    }
}

/// A torque channel that says nothing, of a wrist or of the shoulder, spoils nothing of what the others tell.
#[test]
fn a_dead_torque_channel() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("scores.json");
    for dead in [1, 5] {
        let mut recording = record(&ur5(), &Plan::default());
        let tau = recording.tau.as_mut().expect("torque");
        tau.column_mut(dead).fill(0.0);
        let data = folder.path().join("dead.csv");
        Csv::of(&recording).write(&data);
        let model = train(folder.path(), &data, &["--physics-only"]);
        run(eval(&model, &data).arg("--json").arg(&out)).succeeded();
        let scores = json(&out);
        let nrmse = &row(&scores, "rows", "physics", "all")["nrmse"];
        for joint in (0..6).filter(|j| *j != dead) {
            let nrmse = nrmse[joint].as_f64().expect("a figure");
            // Noise and ripple are about a twentieth of the torque.
            assert!(nrmse < 0.15, "{dead} dead, joint {joint}: {nrmse}");
        }
    }
}

/// A robot on a wall: gravity along the base's −x, written as docs/formats.md has it.
#[test]
fn gravity_of_the_base_frame() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let wall = ur5().with_gravity([-9.81, 0.0, 0.0].into());
    let data = record_to(folder.path(), "wall.csv", &wall, &Plan::default());
    let physics = |gravity: &str| {
        let model = train(
            folder.path(),
            &data,
            &["--physics-only", "--gravity", gravity],
        );
        mean_nrmse(
            &json(&model.join("metrics.json")),
            "train",
            "physics",
            "all",
        )
    };
    let (right, wrong) = (physics("-9.81,0,0"), physics("0,0,-9.81"));
    assert!(
        right < 0.5 * wrong,
        "{right} on the wall, {wrong} on the floor"
    );
}
