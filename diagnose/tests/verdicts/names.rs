//! How far the name of a plain effect is trusted.

use crate::arm::{Shown, drag, moving, nothing, report, reported};
use datasets::{Recording, Trajectory};
use diagnose::Options;
use serde_json::json;

/// What nobody has measured is null.
#[test]
fn probabilities_that_were_not_estimated_are_null() {
    let found = report(&moving(1, &drag), &moving(7, &drag));
    let cause = &found["causes"][0];
    assert_eq!(cause["effect"], "nonlinear_viscous_friction");
    assert!(cause["p_value"].is_null());
    assert_eq!(cause["confirmed"], true);
    let candidates = found["candidates"].as_array().unwrap();
    assert!(!candidates.is_empty());
    assert!(candidates.iter().all(|c| c["p_value"].is_null()));
    let shape = cause["parameters"].as_array().unwrap().iter();
    assert!(
        shape.filter(|p| p["std"] == json!(0.0)).count() == 0,
        "{cause:#}"
    );
}

/// Lead and what is left speak for the name of a plain effect, and weights make a confidence of that, with surrogates or
/// without.
#[test]
fn weights_make_a_confidence_of_lead_and_of_what_is_left() {
    let mut options = Options {
        surrogates: 0,
        ..Options::default()
    };
    let found = reported(&moving(1, &drag), &moving(7, &drag), &options);
    let cause = &found["causes"][0];
    assert_eq!(cause["effect"], "nonlinear_viscous_friction");
    let support = |key: &str| cause["support"][key].as_f64().unwrap();
    assert!(support("lead") > 0.0 && support("left") >= 0.0);
    let sure = cause["confidence"].as_f64().unwrap();
    assert!((0.5..1.0).contains(&sure), "{sure}");
    options.settings.measure.confidence.weights = Some([-0.5, 0.0, 0.0]);
    let short = |seed, trajectories| {
        let (reach, more) = ([0.8, 0.5, 0.6], &drag);
        let shown = Shown {
            seed,
            trajectories,
            seconds: 10.0,
            reach,
            more,
        };
        shown.recording()
    };
    options.surrogates = 19;
    let found = reported(&short(1, 2), &short(7, 2), &options);
    let cause = &found["causes"][0];
    assert_eq!(cause["effect"], "nonlinear_viscous_friction");
    assert!(cause["p_value"].is_number());
    let confidence = cause["confidence"].as_f64().unwrap();
    assert!((confidence - 1.0 / (1.0 + 0.5f64.exp())).abs() < 1e-12);
}

/// Torque that is cut in one run alone is named for it: no other run foretells how much is cut, but the recorded limit says.
#[test]
fn a_limit_that_one_run_reaches_is_named() {
    const LIMIT: f64 = 36.0;
    let runs = |seed, trajectories, seconds, reach| {
        let shown = Shown {
            seed,
            trajectories,
            seconds,
            reach: [0.8, reach, 0.6],
            more: &nothing,
        };
        shown.recording()
    };
    let cut = |seed| {
        let mut strong = runs(seed + 1, 1, 24.0, 2.0);
        let tau = strong.tau.as_mut().unwrap();
        tau.column_mut(1).mapv_inplace(|t| t.clamp(-LIMIT, LIMIT));
        strong.trajectories[0].label = "strong".into();
        Recording::joined(&[runs(seed, 5, 12.0, 0.1), strong]).unwrap()
    };
    let fitted = cut(1);
    let tau = fitted.tau.as_ref().unwrap().column(1);
    let reaches = |t: &&Trajectory| t.range.clone().any(|i| tau[i].abs() >= LIMIT);
    let reached = fitted.trajectories.iter().filter(reaches);
    assert_eq!(
        reached.map(|t| &t.label[..]).collect::<Vec<_>>(),
        ["strong"]
    );
    let found = report(&fitted, &cut(7));
    let cause = &found["causes"][0];
    assert_eq!(cause["effect"], "saturation", "{:#}", found["causes"]);
    assert_eq!(cause["joints"], json!(["j2"]));
    let mut sizes = cause["parameters"].as_array().unwrap().iter();
    let limit = sizes.find(|p| p["name"] == "limit").unwrap();
    assert!((limit["value"].as_f64().unwrap() - LIMIT).abs() < 0.5);
}
