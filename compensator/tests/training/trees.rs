//! Boosted trees on the windows of a unit, beside a ridge regression.

use crate::hysteresis::{TEST, WINDOW, hysteresis, short};
use compensator::training::{Job, Split, Trees, choose_ridge, choose_trees, fit_ridge, grow_trees};

/// The job with part of its training trajectories to choose by.
fn choosing<'a>(job: &Job<'a>) -> Job<'a> {
    Job {
        split: Split {
            train: vec![0, 2, 4, 5],
            validation: vec![7, 9],
        },
        ..job.clone()
    }
}

#[test]
fn trees_learn_hysteresis_better_than_a_line() {
    let data = hysteresis();
    let job = data.job(short(WINDOW));
    let ridge = fit_ridge(&job, choose_ridge(&choosing(&job)).unwrap()).unwrap();
    let count = choose_trees(&choosing(&job)).unwrap();
    let (trees, held) = grow_trees(&job, count).unwrap();
    assert_eq!(trees.count(), count);
    assert!(trees.enabled && trees.leaves() > count);
    let physics = ridge.report.validation_rmse_off.unwrap();
    let [line, grown] = [ridge.report.validation_rmse.unwrap(), held.unwrap()];
    println!("physics {physics:.3}, ridge {line:.3}, {count} trees {grown:.3} N·m");
    assert!(grown < line && line < physics);
    // What is said of the trajectories that judge is what is predicted there, and others are predicted, too.
    let samples = data.samples();
    let torque = trees.predict(&samples, &job.split.validation).unwrap();
    assert!((data.rmse(&torque, &job.split.validation) - grown).abs() < 1e-6);
    let torque = trees.predict(&samples, &TEST).unwrap();
    assert!(data.rmse(&torque, &TEST) < physics);
    assert!(data.trajectories[0].clone().all(|row| torque[row] == 0.0));
}

#[test]
fn the_same_job_grows_the_same_trees() {
    let data = hysteresis();
    let job = data.job(short(WINDOW));
    let grown = || grow_trees(&job, 15).unwrap().0;
    let trees = grown();
    assert_eq!(trees, grown());
    let text = serde_json::to_string(&trees).unwrap();
    let read: Trees = serde_json::from_str(&text).unwrap();
    assert_eq!(trees, read);
}

#[test]
fn damaged_trees_are_refused() {
    let data = hysteresis();
    let job = data.job(short(WINDOW));
    let (trees, _) = grow_trees(&job, 2).unwrap();
    let samples = data.samples();
    let whole = serde_json::to_value(&trees).unwrap();
    let damage = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut value = whole.clone();
        change(&mut value);
        let trees: Trees = serde_json::from_value(value).unwrap();
        let error = trees.predict(&samples, &TEST).unwrap_err().to_string();
        assert!(error.contains("boosted trees"), "{error}");
    };
    // A column that is not there, a child that leads back or out, a tree without a node.
    damage(&|v| v["columns"][0] = 3.into());
    damage(&|v| v["trees"][0][0][0] = 15.into());
    damage(&|v| v["trees"][0][1][2] = 1.into());
    damage(&|v| v["trees"][0][0][3] = 1000.into());
    damage(&|v| v["trees"][1] = serde_json::json!([]));
    damage(&|v| v["timestep"] = 0.into());
}
