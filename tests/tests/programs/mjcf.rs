//! `train` and `eval` on a robot in MuJoCo's format: the same model as of the same robot as a URDF.

use physics::robot::{Description, to_urdf};
use serde_json::Value;
use std::path::{Path, PathBuf};
use tests::program::{json, program, run};
use tests::synthetic::{Plan, record, record_to};

/// Trains on and evaluates a recording; the scores.
fn scores(robot: &Path, data: &Path, folder: &Path) -> Value {
    let model = folder.join("model");
    let mut train = program("train");
    train.args(["--physics-only", "--basic", "--quiet", "--robot"]);
    train.arg(robot).arg("--data").arg(data);
    run(train.arg("--out").arg(&model)).succeeded();
    let mut eval = program("eval");
    eval.arg("--model").arg(&model).arg("--data").arg(data);
    let file = folder.join("scores.json");
    run(eval.arg("--json").arg(&file)).succeeded();
    json(&file)
}

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../physics/tests/fixtures/mjcf")
}

#[test]
fn a_model_is_that_of_the_same_robot_as_a_urdf() {
    let file = models().join("six_axis.xml");
    let (_, robot) = Description::load(&file, &[]).expect("a robot");
    let place = tempfile::tempdir().expect("a temporary folder");
    let data = record_to(place.path(), "r.csv", &robot, &Plan::default());
    let urdf = place.path().join("arm.urdf");
    std::fs::write(&urdf, to_urdf(&robot)).expect("writable");
    let of = |robot: &Path, name: &str| {
        let folder = place.path().join(name);
        std::fs::create_dir(&folder).expect("a folder");
        scores(robot, &data, &folder)
    };
    let (from_mjcf, from_urdf) = (of(&file, "m"), of(&urdf, "u"));
    assert_eq!(from_mjcf["joints"], from_urdf["joints"]);
    let figures = |scores: &Value| -> Vec<f64> {
        let rows = scores["rows"].as_array().into_iter().flatten();
        let means = rows.filter_map(|row| row["mean_nrmse"].as_f64());
        means.collect()
    };
    let (a, b) = (figures(&from_mjcf), figures(&from_urdf));
    assert!(!a.is_empty() && a.len() == b.len());
    for (a, b) in a.iter().zip(&b) {
        assert!((a - b).abs() < 1e-6 * b, "{a} {b}");
    }
}

/// Springs and gravity compensation of the description are part of the model: identified without them, the recording of a
/// robot that has them is not explained.
#[test]
fn springs_and_compensated_weight_are_kept_by_a_model_directory() {
    let file = models().join("springs.xml");
    let (_, robot) = Description::load(&file, &[]).expect("a robot");
    let place = tempfile::tempdir().expect("a temporary folder");
    let mut recording = record(&robot, &Plan::default());
    let q = recording.q.clone();
    let tau = recording.tau.as_mut().expect("a recorded torque");
    for spring in robot.passive() {
        let own = q.column(spring.joint()).mapv(|q| spring.torque(q));
        let mut column = tau.column_mut(spring.joint());
        column += &own;
    }
    let data = place.path().join("r.csv");
    datasets::write(&recording, &data).expect("a recording can be written");
    let scores = scores(&file, &data, place.path());
    let rows = scores["rows"].as_array().expect("rows");
    let physics = rows
        .iter()
        .find(|r| r["name"] == "physics" && r["scope"] == "all");
    let nrmse = physics
        .and_then(|r| r["mean_nrmse"].as_f64())
        .expect("a score");
    assert!(nrmse < 0.15, "{nrmse}");
    let model = json(&place.path().join("model/model.json"));
    let held = &model["physics"]["gravity_compensation"];
    assert_eq!(held.as_array().map(Vec::len), Some(4), "{held}");
    let terms = model["physics"]["terms"].to_string();
    assert!(terms.contains("\"spring\""), "{terms}");
}
