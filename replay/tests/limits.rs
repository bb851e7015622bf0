//! Limits of the drives' torque: what a drive reaches, and a limit that is found beside friction.

use datasets::Recording;
use ndarray::Array2;
use physics::robot::{Robot, drive::Drive};
use replay::arm::Arm;
use replay::command::{Command, Interpolation};
use replay::parameter::Kind;
use replay::simulate::{Track, reached, replay as roll};
use replay::{Done, Options, Subject, replay};

const ARM: &str = r#"<robot name="two"><link name="base"/>
<link name="upper"><inertial><origin xyz="0 0 -0.2"/><mass value="3"/><inertia ixx="0.04" iyy="0.04" izz="0.004" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="fore"><inertial><origin xyz="0 0 -0.15"/><mass value="1.5"/><inertia ixx="0.01" iyy="0.01" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" velocity="9" effort="90"/><dynamics damping="1" friction="0.5"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0 0 -0.4"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" velocity="9" effort="90"/><dynamics damping="0.4" friction="0.2"/></joint></robot>"#;

/// The arm under PD drives; `limit` is a line of the drive file.
fn subject(limit: &str) -> Subject {
    let robot = Robot::from_urdf_str(ARM).expect("a robot");
    let block = format!("[controller]\nkind = \"pd\"\nkp = [200, 80]\nkd = [8, 3]\n{limit}");
    let drive = Drive::from_toml(&block, &robot).expect("a drive file");
    Subject::of(robot, drive).expect("a subject")
}

/// Thirty seconds of two sines for each joint at 100 Hz, from a command at rest; `phase` makes it another motion.
fn track(phase: f64) -> Track {
    let time: Vec<f64> = (0..3000).map(|row| f64::from(row) / 100.0).collect();
    let command = |t: f64, j: usize| {
        let (a, b) = (1.3 + 0.4 * j as f64, 3.1 - 0.7 * j as f64);
        t.min(1.0) * (0.6 * (a * t + phase).sin() + 0.4 * (b * t + 2.0 * phase).sin())
    };
    let commands = (0..2).map(|j| {
        let values = time.iter().map(|t| command(*t, j)).collect();
        Command::new(&time, values, Interpolation::Hold)
    });
    Track {
        trajectory: 0,
        commands: commands.collect(),
        q: Array2::zeros((time.len(), 2)),
        start_velocity: vec![0.0; 2],
        rates: None,
        added: None,
        time,
    }
}

/// What encoders of 0.1 mrad read of the arm `real` under the commands of that motion.
fn recording(real: &Arm, phase: f64) -> Recording {
    let track = track(phase);
    let mut q = Array2::zeros(track.q.dim());
    roll(real, &track, &[], &mut |row, at, _| {
        (0..2).for_each(|j| q[(row, j)] = (at[j] * 1e4).round() / 1e4);
    })
    .expect("stable");
    let q_ref = Array2::from_shape_fn(q.dim(), |(row, j)| track.commands[j].value(track.time[row]));
    Recording {
        q_ref: Some(q_ref),
        ..Recording::new("memory", track.time, q, None)
    }
}

/// Arm whose elbow's drive ends at `limit`, N·m, and whose shoulder has three times the friction.
fn real(limit: f64) -> Arm {
    let mut arm = subject("").given.arm;
    arm.servos[1].limit = limit;
    arm.joints[0].coulomb *= 3.0;
    arm
}

fn diagnosed(limit: &str, real: &Arm) -> Done {
    let options = Options::default().fast(true);
    let data = [recording(real, 0.0)];
    replay(
        subject(limit),
        &data,
        &recording(real, 1.0),
        options,
        |_| {},
    )
    .expect("a diagnosis")
}

#[test]
fn a_drive_reaches_its_limit_and_no_more() {
    let free = reached(&real(f64::INFINITY), &[track(0.0)], Kind::Limit).expect("stable");
    let limit = 0.5 * free[1];
    let cut = reached(&real(limit), &[track(0.0)], Kind::Limit).expect("stable");
    assert_eq!(cut[1], limit);
    // Another limit, that of the control output, is the same for a drive without back EMF and compensation.
    let mut other = real(f64::INFINITY);
    other.servos[1].drive_limit = limit;
    let output = reached(&other, &[track(0.0)], Kind::DriveLimit).expect("stable");
    assert_eq!(output[1], limit);
    // The largest of all tracks.
    let both =
        reached(&real(f64::INFINITY), &[track(0.0), track(1.0)], Kind::Limit).expect("stable");
    let second = reached(&real(f64::INFINITY), &[track(1.0)], Kind::Limit).expect("stable");
    assert_eq!(both[1], free[1].max(second[1]));
}

#[test]
fn a_limit_is_found_beside_friction() {
    let limit = 0.5 * reached(&real(f64::INFINITY), &[track(0.0)], Kind::Limit).expect("stable")[1];
    // Far above what the motion needs, and not given at all.
    for given in ["limit = [400, 400]\n", ""] {
        let done = diagnosed(given, &real(limit));
        let report = &done.outcome.report;
        let mut named: Vec<(&str, &str)> = Vec::new();
        for cause in &report.causes {
            named.extend(cause.joints.iter().map(|j| (cause.effect, j.as_str())));
        }
        named.sort_unstable();
        assert_eq!(
            named,
            [
                ("effort_limit", "elbow"),
                ("friction_parameters", "shoulder")
            ]
        );
        let own = report.causes.iter().find(|c| c.effect == "effort_limit");
        let value = &own.expect("it is named").parameters[0];
        let std = value.std.expect("it is fitted");
        assert!(
            (value.value - limit).abs() < 2.0 * std,
            "{} ± {std} for {limit}",
            value.value
        );
        assert_eq!(value.given, (!given.is_empty()).then_some(400.0));
        // The shoulder has the limit that it was given, or none.
        let shoulder = done.outcome.held.servos[0].limit;
        assert_eq!(shoulder.is_infinite(), given.is_empty(), "{shoulder}");
        let patch = done.patch("two.urdf".as_ref()).expect("files");
        let elbow = patch
            .changes
            .iter()
            .find(|line| line.starts_with("elbow: "));
        let from = if given.is_empty() { "none" } else { "400" };
        assert!(
            elbow.is_some_and(|l| l.contains(&format!("limit {from} → "))),
            "{:?}",
            patch.changes
        );
    }
}

#[test]
fn a_simulator_without_a_gap_is_written_as_given() {
    let same = subject("").given.arm;
    let done = diagnosed("", &same);
    assert_eq!(done.outcome.report.verdict, "no_gap");
    let patch = done.patch("two.urdf".as_ref()).expect("files");
    assert!(patch.changes.is_empty() && patch.left_out.is_empty());
    let text = &patch.files[0].1;
    assert!(text.contains(r#"<mass value="1.5"/>"#), "{text}");
}
