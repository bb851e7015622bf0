//! Guards of a joint whose model is 10 N·m, and 4 N·m more where it turns forwards.

use super::*;
use physics::effects::{Sliding, Term};
use physics::robot::Robot;
use physics::torque_model::{TorqueModelRecord, WeightedTerm};
use proptest::prelude::*;

/// A joint about the vertical, without gravity's share.
const URDF: &str = r#"<robot name="table"><link name="base"/><link name="arm"><inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="2" effort="50"/></joint></robot>"#;

/// A model at 1 kHz without a compensator.
fn loaded(robot: &Robot, terms: Vec<Vec<WeightedTerm>>) -> Feedforward {
    let own = robot.parameters();
    let record = TorqueModelRecord::new(robot, own.clone(), own, terms);
    let json = serde_json::json!({
        "schema": crate::model_file::SCHEMA, "physics": record, "preprocessing": {"fine_hz": 1000.0}, "clock": [], "memory": [],
        "compensator": null,
    });
    Feedforward::from_bytes(json.to_string().as_bytes(), None, None).unwrap()
}

/// A guard at 1 kHz, its ramp of four ticks, held for at most two.
fn guard() -> Guard {
    let robot = Robot::from_urdf_str(URDF).unwrap();
    let term = |term, value| WeightedTerm {
        term,
        value,
        std: 0.0,
    };
    let terms = vec![vec![
        term(Term::Offset, 10.0),
        term(Term::Sliding(Sliding::Coulomb), 4.0),
    ]];
    let mut guard = Guard::new(loaded(&robot, terms));
    let settings = Settings {
        ramp: 0.004,
        hold: 0.002,
        ..guard.settings().clone()
    };
    guard.set(settings).unwrap();
    guard
}

/// Ticks at the given milliseconds at position 0 with the given velocity; torque and status of each.
fn ticks(guard: &mut Guard, at: &[(f64, f64)]) -> Vec<(f64, Status)> {
    let each = at.iter().map(|&(time, qd)| {
        let mut tau = [0.0];
        let status = guard.tick(time * 1e-3, &[0.0], &[qd], &[0.0], &mut tau);
        (tau[0], status)
    });
    each.collect()
}

#[track_caller]
fn same(found: &[(f64, Status)], expected: &[(f64, Status)]) {
    for ((a, status), (b, flags)) in found.iter().zip(expected) {
        assert!((a - b).abs() < 1e-12 && status == flags, "{found:?}");
    }
    assert_eq!(found.len(), expected.len());
}

#[test]
fn starts_and_stops_by_hand() {
    let mut guard = guard();
    let (still, none) = (0.0, Status::default());
    same(
        &ticks(&mut guard, &[(0.0, still)]),
        &[(0.0, Status::STOPPED)],
    );
    guard.start();
    let up = ticks(&mut guard, &[1.0, 2.0, 3.0, 4.0, 5.0].map(|t| (t, still)));
    let starting = Status::STARTING;
    same(
        &up,
        &[
            (2.5, starting),
            (5.0, starting),
            (7.5, starting),
            (10.0, starting),
            (10.0, none),
        ],
    );
    guard.stop();
    let down = ticks(&mut guard, &[6.0, 7.0, 8.0, 9.0, 10.0].map(|t| (t, still)));
    let stopping = Status::STOPPING;
    same(
        &down,
        &[
            (7.5, stopping),
            (5.0, stopping),
            (2.5, stopping),
            (0.0, stopping),
            (0.0, Status::STOPPED),
        ],
    );
    assert_eq!(guard.pace().ticks, 10);
}

#[test]
fn limits_by_hand() {
    let mut guard = guard();
    let settings = Settings {
        torque: vec![12.0],
        rate: vec![1000.0],
        ramp: 0.0,
        ..guard.settings().clone()
    };
    guard.set(settings).unwrap();
    guard.start();
    // One N·m per tick up to 10; 14 is asked for from the eleventh on, of which 12 are let through.
    let found = ticks(
        &mut guard,
        &(0..14)
            .map(|k| (f64::from(k), f64::from(u8::from(k >= 10))))
            .collect::<Vec<_>>(),
    );
    for (k, (tau, status)) in found.iter().enumerate() {
        let expected = (k as f64 + 1.0).min(12.0);
        assert!((tau - expected).abs() < 1e-12, "{k}: {tau}");
        assert_eq!(status.has(Status::RATE_LIMITED), k != 9, "{k}");
        assert_eq!(status.has(Status::TORQUE_LIMITED), k >= 12, "{k}");
    }
    let negative = Settings {
        torque: vec![-1.0],
        ..guard.settings().clone()
    };
    assert!(matches!(
        guard.set(negative),
        Err(SettingsError::Limit { joint: 1, .. })
    ));
    let long = Settings::new(vec![1.0; 2]);
    assert!(matches!(
        guard.set(long),
        Err(SettingsError::Length {
            found: 2,
            joints: 1,
            ..
        })
    ));
}

#[test]
fn bad_input_holds_and_then_stops() {
    let mut guard = guard();
    guard.start();
    ticks(&mut guard, &[0.0, 1.0, 2.0, 3.0].map(|t| (t, 0.0)));
    let found = ticks(&mut guard, &[4.0, 5.0, 6.0, 7.0].map(|t| (t, f64::NAN)));
    let (bad, over) = (
        Status::BAD_INPUT,
        Status::BAD_INPUT | Status::OVERRUN | Status::STOPPING,
    );
    same(
        &found,
        &[(10.0, bad), (10.0, bad), (7.5, over), (5.0, over)],
    );
    // The input is good again: the stop goes on until somebody starts.
    let found = ticks(&mut guard, &[8.0, 9.0, 10.0].map(|t| (t, 0.0)));
    same(
        &found,
        &[
            (2.5, Status::STOPPING),
            (0.0, Status::STOPPING),
            (0.0, Status::STOPPED),
        ],
    );
}

#[test]
fn time_that_stands_runs_back_or_leaps() {
    let mut guard = guard();
    guard.start();
    ticks(&mut guard, &[0.0, 1.0, 2.0, 3.0].map(|t| (t, 0.0)));
    let found = ticks(
        &mut guard,
        &[
            (3.0, 1.0),
            (4.0, 0.0),
            (6.0, 0.0),
            (5.5, 0.0),
            (6.5, 0.0),
            (11.5, 0.0),
        ],
    );
    same(
        &found,
        &[
            (10.0, Status::STALE),
            (10.0, Status::default()),
            (10.0, Status::LATE),
            (10.0, Status::BACKWARD),
            (10.0, Status::default()),
            // Four periods without a tick: longer than the two for which a torque may stand.
            (7.5, Status::LATE | Status::OVERRUN | Status::STOPPING),
        ],
    );
    let pace = guard.pace();
    assert_eq!((pace.late, pace.missed), (2, 5));
}

#[test]
fn a_late_drive_gets_the_torque_of_the_motion_to_come() {
    let mut guard = guard();
    let settings = Settings {
        ramp: 0.0,
        drive_delay: 0.01,
        ..guard.settings().clone()
    };
    guard.set(settings).unwrap();
    guard.start();
    let mut tau = [0.0];
    // It turns backwards at 0.05 rad/s, and forwards 10 ms later: 10 N·m, 4 N·m of friction, 1 kg·m² at 20 rad/s².
    guard.tick(0.0, &[0.0], &[-0.05], &[20.0], &mut tau);
    assert!((tau[0] - 34.0).abs() < 1e-9, "{tau:?}");
    let wrong = Settings {
        drive_delay: -1.0,
        ..guard.settings().clone()
    };
    assert!(matches!(guard.set(wrong), Err(SettingsError::Time { .. })));
}

#[test]
fn a_drive_that_adds_gravity_gets_the_rest_and_starts_at_zero() {
    // A pendulum of 2 kg at 0.5 m, stretched out.
    let urdf = r#"<robot name="p"><link name="b"/><link name="l"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
        <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
        <joint name="j" type="continuous"><parent link="b"/><child link="l"/><axis xyz="0 1 0"/></joint></robot>"#;
    let robot = Robot::from_urdf_str(urdf).unwrap();
    let mut guard = Guard::new(loaded(&robot, vec![vec![]]));
    let settings = Settings {
        drive_adds_gravity: true,
        ..guard.settings().clone()
    };
    guard.set(settings).unwrap();
    guard.start();
    let mut tau = [1.0];
    for k in 0..1000 {
        guard.tick(f64::from(k) * 1e-3, &[0.0], &[0.0], &[0.0], &mut tau);
        assert!(tau[0].abs() < 1e-12, "{k}: {tau:?}");
    }
    // 0.1 + 2 · 0.25 kg·m² at 3 rad/s².
    guard.tick(1.0, &[0.0], &[0.0], &[3.0], &mut tau);
    assert!((tau[0] - 1.8).abs() < 1e-12, "{tau:?}");
}

#[test]
fn a_position_outside_the_limits_is_said() {
    let mut guard = guard();
    let mut tau = [0.0];
    assert!(
        guard
            .tick(0.0, &[1.1], &[0.0], &[0.0], &mut tau)
            .has(Status::POSITION_OUTSIDE)
    );
    assert!(
        !guard
            .tick(1e-3, &[0.9], &[0.0], &[0.0], &mut tau)
            .has(Status::POSITION_OUTSIDE)
    );
}

proptest! {
    #[test]
    fn whatever_comes_in_the_limits_hold(
        calls in proptest::collection::vec((0..12_u8, prop::num::f64::ANY, prop::num::f64::ANY, -2.0..8.0_f64), 1..200),
        torque in 0.0..20.0_f64,
        rate in 0.0..5000.0_f64,
    ) {
        let mut guard = guard();
        let settings = Settings { torque: vec![torque], rate: vec![rate], ..guard.settings().clone() };
        guard.set(settings).unwrap();
        let (mut last, mut time) = (0.0, 0.0);
        for (call, q, qd, step) in calls {
            match call {
                0 => guard.start(),
                1 => guard.stop(),
                _ => {}
            }
            time += step * 1e-3;
            let mut tau = [f64::NAN];
            let status = guard.tick(time, &[q], &[qd], &[0.0], &mut tau);
            prop_assert!(tau[0].abs() <= torque, "{} of {torque}", tau[0]);
            prop_assert!((tau[0] - last).abs() <= rate * 1e-3 * (1.0 + 1e-12) + 1e-12, "{last} to {}", tau[0]);
            prop_assert!(!status.has(Status::STOPPED) || (tau[0] - last).abs() <= last.abs());
            last = tau[0];
        }
    }
}

#[test]
fn a_held_torque_obeys_limits_that_were_lowered() {
    let mut guard = guard();
    guard.start();
    ticks(&mut guard, &[1.0, 2.0, 3.0, 4.0].map(|t| (t, 0.0)));
    let settings = Settings {
        torque: vec![3.0],
        ..guard.settings().clone()
    };
    guard.set(settings).unwrap();
    let held = ticks(&mut guard, &[(5.0, f64::NAN)]);
    same(&held, &[(3.0, Status::BAD_INPUT | Status::TORQUE_LIMITED)]);
}
