//! Pushes.

use crate::arm::{contact, effects, moving, nothing, push, report, standing};
use serde_json::json;

/// Nothing is missing is the last thing to say of a robot at rest that is pushed by 60 N·m.
#[test]
fn pushes_against_a_standing_robot_are_contact() {
    let found = report(&standing(1, &push(60.0)), &standing(7, &push(40.0)));
    assert_eq!(found["verdict"], "explained", "{:#}", found["unexplained"]);
    assert_eq!(effects(&found), ["external_contact"]);
    let pushes = contact(&found).unwrap()["pushes"].as_array().unwrap();
    let of = |name: &str| pushes.iter().filter(|p| p["recording"] == name).count();
    assert_eq!((of("data"), of("heldout")), (4, 4), "{pushes:#?}");
    let first = &pushes[0];
    assert_eq!(
        (&first["trajectory"], &first["link"]),
        (&json!("run0"), &json!("upper"))
    );
    let (start, end) = (
        first["start"].as_f64().unwrap(),
        first["end"].as_f64().unwrap(),
    );
    assert!(
        (start - 4.0).abs() < 0.3 && (end - 5.2).abs() < 0.3,
        "{first}"
    );
    let ladder = found["ladder"].as_array().unwrap();
    assert!(ladder.len() >= 3);
    assert!(ladder[2]["samples"].as_u64() < ladder[1]["samples"].as_u64());
    assert!(ladder[2]["rmse"][1].as_f64() < ladder[1]["rmse"][1].as_f64());
    assert!(
        ladder[0]["nrmse"][0].is_null(),
        "a joint that never moves has no NRMSE"
    );
}

#[test]
fn pushes_in_one_recording_alone_are_contact() {
    let quiet = moving(1, &nothing);
    let here = report(&quiet, &moving(7, &push(40.0)));
    let cause = contact(&here).unwrap_or_else(|| panic!("{:#}", here["causes"]));
    assert!(cause["gap_closed"].as_f64().unwrap() > 0.5, "{cause:#}");
    assert_eq!(cause["confirmed"], true);
    let there = report(&moving(1, &push(40.0)), &moving(7, &nothing));
    let cause = contact(&there).unwrap_or_else(|| panic!("{:#}", there["causes"]));
    assert_eq!(
        (&cause["gap_closed"], &cause["confirmed"]),
        (&json!(0.0), &json!(false))
    );
    let stands = report(&quiet, &standing(7, &push(40.0)));
    assert!(contact(&stands).is_some(), "{:#}", stands["causes"]);
}

/// Who pushes so that it shows also pushes so that it hardly does: that is no effect that nobody knows.
#[test]
fn weak_pushes_beside_strong_ones_are_no_unknown_effect() {
    let strong = push(40.0);
    let more = |run: usize, t: f64, qd: &[f64], j: usize| {
        let since = t - 8.0;
        if run < 3 {
            strong(run, t, qd, j)
        } else if (0.0..1.6).contains(&since) {
            // One joint alone: of itself that is none.
            [0.0, 4.0, 0.0][j] * (std::f64::consts::PI * since / 1.6).sin()
        } else {
            0.0
        }
    };
    let found = report(&moving(1, &more), &moving(7, &nothing));
    let pushes = contact(&found).unwrap()["pushes"].as_array().unwrap();
    assert_eq!(pushes.len(), 3, "{pushes:#?}");
    let left = &found["unexplained"][1];
    assert!(left["nrmse"].as_f64() > Some(0.09), "{left}");
    assert_eq!(found["verdict"], "partly_explained");
}

/// What goes on all the time is structure beside pushes, too.
#[test]
fn an_unknown_effect_beside_pushes_is_told() {
    let strong = push(40.0);
    let more = |run: usize, t: f64, qd: &[f64], j: usize| {
        let turned = |rate: f64| (rate * t + rate * run as f64).sin();
        let shaken = [0.0, 1.0, 0.0][j] * (turned(9.7) + turned(13.1));
        strong(run, t, qd, j) + shaken
    };
    let found = report(&moving(1, &more), &moving(7, &more));
    assert!(contact(&found).is_some(), "{:#}", found["causes"]);
    assert_eq!(
        found["verdict"], "unknown_effect",
        "{:#}",
        found["unexplained"]
    );
}
