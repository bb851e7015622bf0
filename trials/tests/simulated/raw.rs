//! Raw recordings as an estimator meets them.

use physics::robot::Robot;
use trials::raw::{Lag, generate, write};

#[test]
fn a_recording_is_reproducible_whole_and_says_what_is_true() {
    let case = generate(5, 2).unwrap();
    let again = generate(5, 2).unwrap();
    assert_eq!((&case.train, &case.test), (&again.train, &again.test));
    assert_ne!(case.train, generate(5, 3).unwrap().train);
    let n = Robot::from_urdf_str(&case.urdf).unwrap().dof();
    for recording in [&case.train, &case.test] {
        recording.validate().unwrap();
        assert_eq!(recording.dof(), n);
        assert!(recording.len() > 200, "{}", recording.len());
    }
    let truth = &case.truth;
    assert_eq!(truth.joint_delay.len(), n);
    // A causal filter never makes a torque earlier than its shift.
    for (delay, lag) in truth.joint_delay.iter().zip(&truth.lag) {
        let least = truth.shift - 1e-3;
        assert!(*delay > least && *delay < 0.15, "{delay} {lag:?}");
        if *lag == Lag::None {
            assert!((delay - truth.shift).abs() < 1e-3, "{delay}");
        }
    }
}

#[test]
fn files_read_back() {
    let case = generate(5, 0).unwrap();
    let folder = tempfile::tempdir().unwrap();
    write(&case, folder.path()).unwrap();
    let at = folder.path().join("cases").join(&case.id);
    let options = datasets::ReadOptions::for_robot(case.train.dof());
    let read = datasets::read(&at.join("train.csv"), &options).unwrap();
    assert_eq!(read.q, case.train.q);
    assert_eq!(read.tau, case.train.tau);
    let truth = folder
        .path()
        .join("truth")
        .join(format!("{}.json", case.id));
    let truth: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(truth).unwrap()).unwrap();
    assert_eq!(truth["delay"], case.truth.delay);
    assert_eq!(
        truth["gain"].as_array().unwrap().len(),
        case.truth.gain.len()
    );
}
