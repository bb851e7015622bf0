//! Every finding of the check on a recording made to have that fault alone: a UR5 that is its own model.

use datasets::check::{CheckReport, Kind, Severity};
use datasets::{PrepareOptions, Recording, Trajectory};
use model::preparation::check::check_recording;
use ndarray::Array2;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::Robot;

const SAMPLES: usize = 2000;

/// Position, velocity and acceleration of one joint at time t: three incommensurate sines.
type Motion = fn(usize, f64) -> [f64; 3];

fn sines(list: [(f64, f64, f64); 3], t: f64) -> [f64; 3] {
    list.iter().fold([0.0; 3], |[q, v, a], &(size, w, phase)| {
        let (s, c) = (w * t + phase).sin_cos();
        [q + size * s, v + size * w * c, a - size * w * w * s]
    })
}

fn lively(joint: usize, t: f64) -> [f64; 3] {
    let j = joint as f64;
    let [q, v, a] = sines(
        [
            (0.6, 0.9 + 0.17 * j, j),
            (0.35, 2.3 + 0.31 * j, 2.0 * j),
            (0.12, 5.1 - 0.43 * j, 0.7 * j),
        ],
        t,
    );
    [q + [0.0, -1.2, 1.0, -0.6, 0.5, 0.0][joint], v, a]
}

/// 20 s at 100 Hz in two trajectories, with viscous and Coulomb friction and the torque `delay` s behind.
fn recording(motion: Motion, delay: f64) -> Recording {
    let robot = Robot::builtin("ur5").unwrap();
    let mut workspace = Workspace::new(&robot);
    let time: Vec<f64> = (0..SAMPLES).map(|k| 0.01 * k as f64).collect();
    let mut q = Array2::zeros((SAMPLES, 6));
    let mut tau = Array2::zeros((SAMPLES, 6));
    for (k, &t) in time.iter().enumerate() {
        let state = |t: f64| -> [Vec<f64>; 3] {
            let all: Vec<[f64; 3]> = (0..6).map(|j| motion(j, t)).collect();
            [0, 1, 2].map(|i| all.iter().map(|s| s[i]).collect())
        };
        let [now, _, _] = state(t);
        let [then, v, a] = state(t - delay);
        let mut torque = vec![0.0; 6];
        inverse_dynamics(&robot, &mut workspace, &then, &v, &a, &mut torque);
        for j in 0..6 {
            q[(k, j)] = now[j];
            let friction = if v[j] == 0.0 { 0.0 } else { v[j].signum() };
            // A little that is no function of the motion.
            let noise = 0.02 * (k as f64 * (12.9 + j as f64)).sin();
            tau[(k, j)] = torque[j] + 0.4 * friction + 0.6 * v[j] + noise;
        }
    }
    let mut recording = Recording::new("made", time, q, Some(tau));
    recording.trajectories = [0..SAMPLES / 2, SAMPLES / 2..SAMPLES]
        .into_iter()
        .map(|range| Trajectory {
            label: range.start.to_string(),
            range,
        })
        .collect();
    recording
}

fn checked(recording: &Recording) -> CheckReport {
    let options = PrepareOptions {
        cutoff_hz: Some(15.0),
        ..PrepareOptions::default()
    };
    check_recording(&Robot::builtin("ur5").unwrap(), recording, &options).unwrap()
}

fn kinds(recording: &Recording) -> Vec<(Kind, Option<usize>)> {
    let findings = checked(recording).findings;
    findings.iter().map(|f| (f.kind, f.joint)).collect()
}

fn torque(recording: &mut Recording) -> &mut Array2<f64> {
    recording.tau.as_mut().unwrap()
}

#[test]
fn a_good_recording_has_no_findings() {
    let report = checked(&recording(lively, 0.0));
    assert!(report.findings.is_empty(), "{:#?}", report.findings);
}

#[test]
fn torque_in_another_unit_or_reversed() {
    for factor in [10.0, 1.0 / 101.0, -1.0] {
        let mut r = recording(lively, 0.0);
        torque(&mut r).column_mut(1).mapv_inplace(|t| factor * t);
        let CheckReport {
            findings: found,
            channel,
            ..
        } = checked(&r);
        assert!(!found.is_empty(), "{factor}: {channel:?}");
        assert_eq!(found[0].kind, Kind::TorqueScale, "{factor}: {found:?}");
        assert_eq!(
            (found[0].joint, found[0].severity),
            (Some(1), Severity::Severe)
        );
        assert!(found[0].message.contains("shoulder_lift_joint"));
    }
}

#[test]
fn torque_behind_or_before_the_motion() {
    for delay in [0.02, -0.013] {
        let found = checked(&recording(lively, delay)).findings;
        assert_eq!(found.len(), 1, "{delay}: {found:?}");
        assert_eq!((found[0].kind, found[0].joint), (Kind::TorqueShift, None));
        assert!((found[0].value - delay).abs() < 0.002, "{}", found[0].value);
    }
}

#[test]
fn motion_that_does_not_tell_parameters_apart() {
    // All joints in step: inertia, first moments and friction of neighbours look alike.
    let found = checked(&recording(
        |_, t| sines([(0.8, 1.5, 0.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0)], t),
        0.0,
    ));
    let poor = found
        .findings
        .iter()
        .find(|f| f.kind == Kind::PoorConditioning);
    let poor = poor.expect("named");
    assert!(poor.value > 100.0 && poor.parameters.len() > 5, "{poor:?}");
    assert!(poor.message.contains(&poor.parameters.join(", ")));
    let json = serde_json::to_value(&found).unwrap();
    let listed = json["findings"].as_array().unwrap();
    let listed = listed
        .iter()
        .find(|f| f["kind"] == "poor_conditioning")
        .unwrap();
    assert_eq!(listed["parameters"][0], poor.parameters[0].as_str());
}

#[test]
fn a_joint_that_never_moves_is_named_with_its_parameters() {
    fn still(joint: usize, t: f64) -> [f64; 3] {
        if joint == 5 {
            [0.2, 0.0, 0.0]
        } else {
            lively(joint, t)
        }
    }
    let found = checked(&recording(still, 0.0)).findings;
    assert_eq!((found[0].kind, found[0].joint), (Kind::NeverMoves, Some(5)));
    let poor = found
        .iter()
        .find(|f| f.kind == Kind::PoorConditioning)
        .unwrap();
    for name in ["fv6", "fc6"] {
        assert!(poor.parameters.iter().any(|p| p == name), "{poor:?}");
    }
    assert!(!poor.parameters.iter().any(|p| p == "fv2"), "{poor:?}");
}

#[test]
fn too_slow_too_short_too_small() {
    fn slow(joint: usize, t: f64) -> [f64; 3] {
        if joint == 2 {
            sines([(0.3, 0.12, 0.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0)], t)
        } else {
            lively(joint, t)
        }
    }
    let found = kinds(&recording(slow, 0.0));
    assert!(found.contains(&(Kind::TooSlow, Some(2))), "{found:?}");
    assert!(found.contains(&(Kind::TooShort, Some(2))), "{found:?}");
    fn small(joint: usize, t: f64) -> [f64; 3] {
        if joint == 3 {
            sines([(0.03, 4.0, 0.0), (0.02, 9.0, 0.0), (0.0, 1.0, 0.0)], t)
        } else {
            lively(joint, t)
        }
    }
    let found = kinds(&recording(small, 0.0));
    assert!(
        found.contains(&(Kind::RegionTooSmall, Some(3))),
        "{found:?}"
    );
    assert!(!found.iter().any(|(k, _)| *k == Kind::TooSlow), "{found:?}");
}

#[test]
fn plateau_dead_channel_corrupt_row_and_clock() {
    let mut r = recording(lively, 0.0);
    let most = torque(&mut r)
        .column(1)
        .iter()
        .fold(0.0_f64, |m, t| m.max(t.abs()));
    torque(&mut r)
        .column_mut(1)
        .mapv_inplace(|t| t.clamp(-0.7 * most, 0.7 * most));
    assert!(kinds(&r).contains(&(Kind::TorquePlateau, Some(1))));

    let mut r = recording(lively, 0.0);
    torque(&mut r).column_mut(4).fill(0.0);
    assert!(kinds(&r).contains(&(Kind::DeadChannel, Some(4))));

    let mut r = recording(lively, 0.0);
    r.q[(700, 0)] += 0.4;
    let found = checked(&r).findings;
    let corrupt = found.iter().find(|f| f.kind == Kind::CorruptRow).unwrap();
    assert_eq!((corrupt.joint, corrupt.row), (Some(0), Some(701)));

    let mut r = recording(lively, 0.0);
    r.time[600..].iter_mut().for_each(|t| *t += 0.08);
    let found = checked(&r).findings;
    let jump = found.iter().find(|f| f.kind == Kind::ClockJump).unwrap();
    assert_eq!(jump.row, Some(601));
}

#[test]
fn repeats_are_found_by_their_motion() {
    let mut r = recording(lively, 0.0);
    let half = SAMPLES / 2;
    for k in 0..half {
        for j in 0..6 {
            r.q[(half + k, j)] = r.q[(k, j)];
            let again = torque(&mut r)[(k, j)] + if k % 2 == 0 { 0.3 } else { -0.3 };
            torque(&mut r)[(half + k, j)] = again;
        }
    }
    let floor = checked(&r).repeatability.expect("repeats");
    assert_eq!(floor.pairs, [(0, 1)]);
    assert!(
        (floor.all[2] - 0.3 / 2.0_f64.sqrt()).abs() < 1e-6,
        "{floor:?}"
    );
}

#[test]
fn a_recording_without_torque_is_checked_for_its_motion() {
    let mut r = recording(lively, 0.0);
    r.tau = None;
    assert!(checked(&r).findings.is_empty());
}
