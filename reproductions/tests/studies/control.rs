//! `eval --closed-loop` and `eval --collision`.

use physics::robot::Robot;
use serde_json::Value;
use std::path::{Path, PathBuf};
use tests::program::{json, program, run};
use tests::synthetic::{Plan, record};

fn trained(folder: &Path) -> PathBuf {
    let robot = Robot::builtin("ur5").expect("built in");
    let data = folder.join("train.csv");
    datasets::write(&record(&robot, &Plan::default()), &data).expect("writable");
    let out = folder.join("model");
    let mut train = program("train");
    train.args([
        "--robot",
        "ur5",
        "--basic",
        "--physics-only",
        "--quiet",
        "--data",
    ]);
    run(train.arg(&data).arg("--out").arg(&out)).succeeded();
    out
}

/// A number of a report.
#[track_caller]
fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}

/// The three machines of the manual, in its direction: with the model they settle sooner, and axis 2 errs less.
#[test]
fn the_machines_gain_as_the_manual_says() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| folder.path().join(name);
    let ended = run(program("eval")
        .arg("--closed-loop")
        .arg("--json")
        .arg(place("loop.json"))
        .arg("--html")
        .arg(place("loop.html")));
    ended.succeeded();
    assert!(ended.out.contains("published, without"), "{}", ended.out);
    let report = json(&place("loop.json"));
    assert_eq!(report["schema"], "closed-loop/1");
    let experiments = report["experiments"].as_array().expect("a list");
    assert_eq!(experiments.len(), 3);
    for experiment in experiments {
        let ours = &experiment["published"]["ours"];
        let (without, with) = (number(&ours[0]), number(&ours[1]));
        assert!(with < without, "{}: {without} {with}", experiment["robot"]);
    }
    let page = std::fs::read_to_string(place("loop.html")).expect("a page");
    assert!(page.matches("<svg").count() >= 5);
}

#[test]
fn collisions_in_a_recording() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| folder.path().join(name);
    let model = trained(folder.path());
    let robot = Robot::builtin("ur5").expect("built in");
    let plan = |seed| Plan {
        seed,
        trajectories: 8,
        ..Plan::default()
    };
    let clean = record(&robot, &plan(2));
    datasets::write(&clean, &place("clean.csv")).expect("writable");
    let mut pushed = record(&robot, &plan(3));
    // 60 N·m at the elbow for 0.3 s of the second trajectory.
    let start = pushed.trajectories[1].range.start + 200;
    let at = pushed.time[start];
    let tau = pushed.tau.as_mut().expect("torque");
    for row in start..start + 30 {
        tau[[row, 2]] -= 60.0;
    }
    datasets::write(&pushed, &place("pushed.csv")).expect("writable");
    let eval = |data: &str, more: &[&str]| {
        let mut eval = program("eval");
        eval.args(["--collision", "--false-alarms", "1", "--model"])
            .arg(&model);
        eval.arg("--data").arg(place(data)).args(more);
        eval.arg("--json").arg(place("found.json"));
        run(eval.arg("--html").arg(place("found.html")))
    };
    let calibration = place("clean.csv");
    let calibration = [
        "--calibration",
        calibration.to_str().expect("a name in UTF-8"),
    ];
    eval("pushed.csv", &calibration).succeeded();
    let report = json(&place("found.json"));
    assert_eq!(report["schema"], "collision/2");
    for detector in report["detectors"].as_array().expect("a list") {
        let alarms = detector["alarms"].as_array().expect("a list");
        let elbow = alarms.iter().find(|a| a["joint"] == 2);
        let elbow = elbow.unwrap_or_else(|| panic!("no alarm of the elbow: {alarms:?}"));
        assert_eq!(
            (&elbow["trajectory"], &elbow["name"]),
            (&"t2".into(), &"elbow_joint".into())
        );
        assert!(
            (0.0..0.05).contains(&(number(&elbow["time"]) - at)),
            "{elbow}"
        );
        assert_eq!(detector["thresholds"].as_array().map(Vec::len), Some(6));
    }
    // What the thresholds come from is quiet.
    let ended = eval("clean.csv", &[]);
    ended.succeeded();
    for detector in json(&place("found.json"))["detectors"]
        .as_array()
        .expect("a list")
    {
        assert_eq!(
            detector["alarms"],
            Value::Array(Vec::new()),
            "{}",
            ended.out
        );
    }
    assert!(ended.out.contains("No alarm"));
    assert!(
        std::fs::read_to_string(place("found.html"))
            .expect("a page")
            .contains("<svg")
    );
}

#[test]
fn refusals() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let ended = run(program("eval").args(["--closed-loop", "--data", "x.csv"]));
    assert_eq!(ended.status, 2, "{}", ended.err);
    let ended = run(program("eval").args(["--collision", "--model", "x"]));
    assert_eq!(ended.status, 2, "{}", ended.err);
    run(program("eval")
        .args(["--closed-loop", "--model"])
        .arg(folder.path()))
    .refused(&["model.json"]);
    // A robot that nothing simulates, and a recording too short for a threshold.
    let model = trained(folder.path());
    let robot = Robot::builtin("ur5").expect("built in");
    let short = folder.path().join("short.csv");
    let plan = Plan {
        trajectories: 1,
        ..Plan::default()
    };
    datasets::write(&record(&robot, &plan), &short).expect("writable");
    let mut eval = program("eval");
    eval.args(["--collision", "--model"])
        .arg(&model)
        .arg("--data")
        .arg(&short);
    run(&mut eval).refused(&["short.csv", "at least 20 s"]);
    eval.args(["--false-alarms", "0"]);
    run(&mut eval).refused(&["--false-alarms 0"]);
    let path = model.join("model.json");
    let text = std::fs::read_to_string(&path).expect("readable");
    std::fs::write(&path, text.replace("\"builtin\": \"ur5\",", "")).expect("writable");
    run(program("eval")
        .args(["--closed-loop", "--model"])
        .arg(&model))
    .refused(&["no simulated ur5", "kr300"]);
}
