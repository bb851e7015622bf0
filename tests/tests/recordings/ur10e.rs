//! A real UR10e without load, from the shared data: two recordings to learn from, a third to be judged by.

use serde_json::Value;
use std::path::Path;
use tests::program::{json, program, row, run};
use tests::shared::shared;

/// RMSE of the physics on the held-out recording, mean over joints, N·m.
fn mean_rmse(data: &Path, folder: &Path, extra: &[&str]) -> f64 {
    let out = folder.join("model");
    let mut train = program("train");
    train.args(["--physics-only", "--quiet"]).args(extra);
    train.arg("--robot").arg(data.join("robot.urdf"));
    train.arg("--data");
    for name in ["20_02_12-50sec_12harm", "20_02_19_14harm50sec"] {
        train.arg(data.join(name).with_extension("csv"));
    }
    train.arg("--heldout");
    train.arg(data.join("20_02_19_15harm50sec.csv"));
    run(train.arg("--out").arg(&out)).succeeded();
    let metrics = json(&out.join("metrics.json"));
    let rmse = &row(&metrics, "heldout", "physics", "all")["rmse"];
    let figures: Vec<f64> = rmse
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_f64)
        .collect();
    assert_eq!(figures.len(), 6, "one figure per joint");
    figures.iter().sum::<f64>() / 6.0
}

/// The effects beyond rotor inertia, viscous and Coulomb friction and offset pay on a motion not seen before.
#[test]
fn effects_pay_on_a_recording_not_seen() {
    let Some(data) = shared("data/ur10e") else {
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let basic = mean_rmse(&data, folder.path(), &["--basic"]);
    let chosen = mean_rmse(&data, folder.path(), &[]);
    println!("mean RMSE: basic {basic:.4} N·m, with effects {chosen:.4} N·m");
    assert!(chosen <= 1.02 * 1.398, "{chosen} N·m, 1.398 N·m before");
    assert!(
        chosen <= 0.8 * basic,
        "{:.1} % lower ({basic} to {chosen} N·m), target 20 %",
        100.0 * (1.0 - chosen / basic)
    );
}
