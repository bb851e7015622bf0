//! The KR300 benchmark from the shared data: nothing is fitted to or chosen on the test file.
//!
//! One test, so that two trainings do not share the cores: about three minutes on two.

use serde_json::Value;
use std::path::Path;
use tests::program::{json, mean_nrmse, program, run};
use tests::shared::shared;

fn metrics(data: &Path, folder: &Path, extra: &[&str]) -> Value {
    let out = folder.join("model");
    let mut train = program("train");
    train.args(["--robot", "kr300", "--quiet"]).args(extra);
    train.arg("--data").arg(data.join("train.parquet"));
    train.arg("--heldout").arg(data.join("test.parquet"));
    run(train.arg("--out").arg(&out)).succeeded();
    json(&out.join("metrics.json"))
}

/// Held-out mean NRMSE of a model at most `target`.
#[track_caller]
fn at_most(metrics: &Value, name: &str, scope: &str, target: f64) {
    let found = mean_nrmse(metrics, "heldout", name, scope);
    assert!(found <= target, "{name}, {scope}: {found}, target {target}");
}

#[test]
#[ignore = "long: .ci/release"]
fn reaches_the_targets() {
    let Some(data) = shared("data/kr300") else {
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let gain = |metrics: &Value, scope: &str| {
        let [with, without] = ["physics+compensator", "physics"]
            .map(|name| mean_nrmse(metrics, "heldout", name, scope));
        println!("{scope}: physics {without:.4}, with compensator {with:.4}");
        1.0 - with / without
    };

    let all = metrics(&data, folder.path(), &[]);
    let linear = mean_nrmse(&all, "heldout", "linear_baseline", "all");
    assert!((linear / 0.586 - 1.0).abs() < 0.05, "baseline {linear}");
    let gained = gain(&all, "all");
    at_most(&all, "physics", "all", 0.12);
    at_most(&all, "physics+compensator", "all", 0.085);
    assert!(gained >= 0.1, "{gained} better than the physics alone");

    let moving = metrics(&data, folder.path(), &["--moving-only"]);
    let gained = gain(&moving, "moving");
    at_most(&moving, "physics", "moving", 0.05);
    at_most(&moving, "physics+compensator", "moving", 0.037);
    assert!(gained >= 0.1, "{gained} better than the physics alone");
}
