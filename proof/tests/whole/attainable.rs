//! What can be known of a sealed case.

use proof::attainable::attainable;
use proof::prove::Draw;
use trials::cases::Sensors;

/// The observer's torque of the true mechanism leaves the noise alone, and its choice is the truth.
#[test]
fn the_observer_knows_what_is_large_and_plain() {
    let draw = Draw {
        cases: 1,
        seed: 31,
        hard: true,
        only: Some("stribeck_friction"),
        without: None,
        generator: 2,
        sensors: Sensors::default(),
    };
    let folder = tempfile::tempdir().unwrap();
    let known = attainable(&draw, Some(folder.path()), || ()).unwrap();
    let [one] = &known[..] else {
        panic!("one case")
    };
    assert_eq!((one.score.top1, one.score.extra), (Some(1.0), Some(0.0)));
    assert!(one.probability > 0.5 && one.probability <= 1.0 + 1e-12);
    let left = one.left.unwrap();
    assert!((0.9..1.1).contains(&left), "{left}");
    // A second run reads the answer.
    let again = attainable(&draw, Some(folder.path()), || ()).unwrap();
    assert_eq!(again[0].left, one.left);
}
