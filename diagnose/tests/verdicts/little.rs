//! Recordings that say little.

use crate::arm::{Extra, Noise, Shown, effects, moving, nothing, report, reported, standing};
use diagnose::Options;
use serde_json::json;

#[test]
fn a_robot_of_which_nothing_is_missing_has_no_gap() {
    let found = report(&moving(1, &nothing), &moving(7, &nothing));
    assert_eq!(found["verdict"], "no_gap", "{:#}", found["unexplained"]);
    assert_eq!(effects(&found), Vec::<&str>::new());
}

#[test]
fn a_robot_at_rest_tells_nothing() {
    let found = report(&standing(1, &nothing), &standing(7, &nothing));
    assert_eq!(found["verdict"], "cannot_tell");
    assert!(
        found["reason"].as_str().unwrap().contains("motion"),
        "{}",
        found["reason"]
    );
    assert_eq!(effects(&found), Vec::<&str>::new());
    assert_eq!(found["ladder"][1]["step"], "reidentified");
}

/// The rest is judged where one channel is dead; without any there is nothing to judge.
#[test]
fn a_dead_channel_hides_its_joint_alone() {
    let dead = |joints: std::ops::Range<usize>, seed| {
        let mut r = moving(seed, &nothing);
        let tau = r.tau.as_mut().unwrap();
        joints.for_each(|j| tau.column_mut(j).fill(0.0));
        r
    };
    let found = report(&dead(1..2, 1), &dead(1..2, 7));
    assert_eq!(found["verdict"], "no_gap", "{:#}", found["unexplained"]);
    assert!(found["ladder"][0]["rmse"][1].is_null() && found["ladder"][0]["nrmse"][1].is_null());
    assert!(found["ladder"][0]["nrmse"][0].as_f64().unwrap() < 0.05);
    let hidden = found["not_identifiable"].as_array().unwrap();
    let of_joint = hidden.iter().filter(|h| h["effect"].is_null());
    assert_eq!(
        of_joint.map(|h| &h["joints"]).collect::<Vec<_>>(),
        [&json!(["j2"])]
    );
    let none = report(&dead(0..3, 1), &dead(0..3, 7));
    assert_eq!(none["verdict"], "cannot_tell");
    assert!(none["ladder"][1]["mean_nrmse"].is_null());
}

/// What is left without a cause and without a pattern is no reason to say that nothing is missing.
#[test]
fn a_rest_without_a_pattern_is_not_nothing() {
    // Slow, different in every run, and little beside the joint's torque: nothing foretells it.
    let slow = |seed: u32| {
        move |run: usize, t: f64, _: &[f64], j: usize| {
            let mut draw = Noise(seed * 977 + run as u32 * 131);
            for _ in 0..5 {
                draw.next();
            }
            let (w, phase) = (4.0 + 2.0 * draw.next(), 6.0 * draw.next());
            [0.0, 0.28, 0.0][j] * (w * t + phase).sin()
        }
    };
    let found = report(&moving(1, &slow(1)), &moving(7, &slow(7)));
    assert!(effects(&found).is_empty(), "{:#}", found["causes"]);
    // Whether so slow a rest counts as structure or as none, something is left and no cause is named.
    let verdict = found["verdict"].as_str();
    assert!(
        matches!(verdict, Some("cannot_tell" | "unknown_effect")),
        "{verdict:?}: {:#}",
        found["unexplained"]
    );
}

/// A joint that never moves has no figure, in either scope, and is in no mean.
#[test]
fn a_parked_joint_is_in_no_mean() {
    let parked = |seed| {
        Shown {
            seed,
            trajectories: 6,
            seconds: 12.0,
            reach: [0.8, 0.5, 0.0],
            more: &nothing,
        }
        .recording()
    };
    let found = report(&parked(1), &parked(7));
    for step in &found["ladder"].as_array().unwrap()[..2] {
        for scope in [step, &step["moving"]] {
            assert!(
                scope["nrmse"][2].is_null() && scope["r2"][2].is_null(),
                "{scope}"
            );
            let known: Vec<f64> = (0..2)
                .map(|j| scope["nrmse"][j].as_f64().unwrap())
                .collect();
            let mean = scope["mean_nrmse"].as_f64().unwrap();
            assert!((mean - 0.5 * (known[0] + known[1])).abs() < 1e-12);
        }
    }
}

/// Four runs of a second: too short for a null, not for what is most of a joint's error in each of them.
#[test]
fn four_seconds_show_a_wrist_that_is_coupled() {
    let short = |seed, more: &Extra| {
        let reach = [0.8, 0.5, 0.6];
        Shown {
            seed,
            trajectories: 4,
            seconds: 1.0,
            reach,
            more,
        }
        .recording()
    };
    let coupled = |_: usize, _: f64, qd: &[f64], j: usize| [0.0, 0.0, 0.4][j] * qd[0];
    let found = report(&short(1, &coupled), &moving(7, &coupled));
    let causes = found["causes"].as_array().unwrap();
    let own = causes.iter().find(|c| c["effect"] == "joint_coupling");
    let own = own.unwrap_or_else(|| panic!("{:#}", found["causes"]));
    assert_eq!(
        (&own["joints"][0], &own["driver"]),
        (&json!("j3"), &json!("j1"))
    );
    assert!(own["confidence"].is_null() && own["p_value"].is_null());
    assert_eq!(own["remark"], "short recording");
    let notes = found["notes"].as_array().unwrap();
    let said = |n: &serde_json::Value| n.as_str().unwrap().starts_with("short recording");
    assert!(notes.iter().any(said), "{notes:#?}");
    // By its gain in nats it would not be.
    let mut long = Options::default();
    long.settings.ladder.fewest = 0.0;
    let found = reported(&short(1, &coupled), &moving(7, &coupled), &long);
    assert!(
        !effects(&found).contains(&"joint_coupling"),
        "{:#}",
        found["causes"]
    );
    let sound = report(&short(1, &nothing), &moving(7, &nothing));
    let structural = sound["causes"].as_array().unwrap();
    assert!(
        structural.iter().all(|c| c["kind"] == "parameter"),
        "{structural:#?}"
    );
}
