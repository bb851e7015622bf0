//! Sensitivities of a replay against differences of replays, and a joint at rest on a slope.

use ndarray::Array2;
use physics::robot::Robot;
use replay::arm::{Arm, Integral, Servo};
use replay::command::{Command, Interpolation};
use replay::fit::errors;
use replay::parameter::{Kind, Parameter};
use replay::simulate::{Track, replay as roll};

fn servo() -> Servo {
    Servo {
        kp: 3000.0,
        kd: 200.0,
        ki: 0.0,
        integral: Integral::None,
        back_emf: 0.0,
        drive_limit: f64::INFINITY,
        limit: f64::INFINITY,
        delay: 0.012,
        lag: 0.02,
        offset: 0.01,
    }
}

/// An arm that has every term, and two seconds of sines that no joint stops in.
fn example() -> (Arm, Track) {
    let robot = Robot::builtin("ur5").expect("built in");
    let n = robot.dof();
    let mut arm = Arm::new(robot, vec![servo(); n]);
    arm.gravity_compensation = 0.4;
    arm.servos[2].integral = Integral::Position;
    arm.servos[2].ki = 500.0;
    for joint in &mut arm.joints {
        joint.damping = 20.0;
        joint.armature = 0.5;
        joint.load = 0.05;
        joint.stribeck = 0.5;
        // Coulomb friction stops joints, and what rests has no derivative; it has a test of its own.
        joint.stribeck_velocity = 0.5;
        (
            joint.unknown.coefficients[1],
            joint.unknown.coefficients[25],
        ) = (3.0, 2.0);
    }
    let time: Vec<f64> = (0..400).map(|k| 0.005 * f64::from(k)).collect();
    let wave =
        |t: f64, j: usize| 0.3 * (1.0 + 0.2 * j as f64) * (2.0 * t + j as f64).sin() + 0.6 * t;
    let table = |f: &dyn Fn(f64, usize) -> f64| {
        let commands = (0..n).map(|j| {
            let values = time.iter().map(|t| f(*t, j)).collect();
            Command::new(&time, values, Interpolation::Linear)
        });
        commands.collect::<Vec<_>>()
    };
    let q = Array2::from_shape_fn((time.len(), n), |(r, j)| wave(time[r], j));
    let rate = |t: f64, j: usize| (wave(t + 1e-4, j) - wave(t - 1e-4, j)) / 2e-4;
    let track = Track {
        trajectory: 0,
        q,
        start_velocity: (0..n).map(|j| rate(0.0, j)).collect(),
        commands: table(&wave),
        rates: Some(table(&rate)),
        added: Some(table(&|t, j| 4.0 * (3.0 * t + j as f64).cos())),
        time,
    };
    (arm, track)
}

#[test]
fn sensitivities_are_differences_of_replays() {
    let (mut arm, track) = example();
    let kinds = [
        Kind::Gain,
        Kind::ServoDamping,
        Kind::Damping,
        Kind::Armature,
        Kind::Load,
        Kind::Offset,
        Kind::Lag,
        Kind::Delay,
        Kind::Zero,
        Kind::LinkScale,
        Kind::Coupling(1),
        Kind::Coupling(3),
        Kind::StribeckVelocity,
        Kind::Unknown(1),
    ];
    let mut parameters: Vec<Parameter> = kinds.iter().map(|k| Parameter::new(*k, 2)).collect();
    parameters.extend(
        [
            Kind::CommonDelay,
            Kind::GravityCompensation,
            Kind::Tilt(0),
            Kind::Tilt(1),
        ]
        .map(|k| Parameter::new(k, 0)),
    );
    parameters.push(Parameter::new(Kind::Integral, 2));
    arm.set(&[
        (Parameter::new(Kind::Payload(0), 0), 1.0),
        (Parameter::new(Kind::Payload(1), 0), 0.1),
        (Parameter::new(Kind::Coupling(1), 2), 0.2),
        (Parameter::new(Kind::Coupling(4), 5), -0.3),
    ])
    .expect("a body");
    parameters.push(Parameter::new(Kind::Payload(0), 0));
    parameters.push(Parameter::new(Kind::Payload(2), 0));
    parameters.push(Parameter::new(Kind::Payload(4), 0));
    parameters.push(Parameter::new(Kind::LinkScale, 5));
    let (n, p) = (arm.dof(), parameters.len());
    let mut last = Vec::new();
    roll(&arm, &track, &parameters, &mut |_, _, dq| {
        last = dq.to_vec()
    })
    .expect("stable");
    let end = track.q.nrows() - 1;
    for (k, parameter) in parameters.iter().enumerate() {
        let value = arm.get(*parameter);
        let step = 1e-5 * value.abs().max(1e-2);
        let at = |by: f64| {
            let mut moved = arm.clone();
            moved.set(&[(*parameter, value + by)]).expect("possible");
            errors(&moved, &track).expect("stable")
        };
        let (up, down) = (at(step), at(-step));
        let difference = |j: usize| (up[end * n + j] - down[end * n + j]) / (2.0 * step);
        let scale = (0..n).map(|j| difference(j).abs()).fold(0.0, f64::max);
        assert!(scale > 0.0, "{parameter:?} changes nothing");
        for j in 0..n {
            let own = last[j * p + k];
            assert!(
                (own - difference(j)).abs() < 0.02 * scale,
                "{parameter:?}, joint {j}: {own} by sensitivity, {} by differences",
                difference(j)
            );
        }
    }
}

#[test]
fn a_joint_rests_on_a_slope() {
    let robot = Robot::builtin("ur5").expect("built in");
    let n = robot.dof();
    // No drive at all: friction alone holds the arm, stretched out.
    let mut idle = servo();
    (idle.kp, idle.kd, idle.lag, idle.delay, idle.offset) = (1e-9, 0.0, 0.0, 0.0, 0.0);
    let mut arm = Arm::new(robot, vec![idle; n]);
    arm.joints.iter_mut().for_each(|j| j.coulomb = 200.0);
    let time: Vec<f64> = (0..100).map(|k| 0.02 * f64::from(k)).collect();
    let hold = || Command::new(&time, vec![0.0; 100], Interpolation::Hold);
    let track = Track {
        trajectory: 0,
        q: Array2::zeros((100, n)),
        start_velocity: vec![0.0; n],
        commands: (0..n).map(|_| hold()).collect(),
        rates: None,
        added: None,
        time: time.clone(),
    };
    let held = errors(&arm, &track).expect("stable");
    assert!(held.iter().all(|e| *e == 0.0), "it does not move by a bit");
    arm.joints.iter_mut().for_each(|j| j.coulomb = 1.0);
    let fallen = errors(&arm, &track).expect("stable");
    assert!(fallen[99 * n + 1].abs() > 0.5, "without friction it falls");
}

#[test]
fn an_added_torque_acts_late_and_inside_the_limit() {
    let robot = Robot::builtin("ur5").expect("built in");
    let n = robot.dof();
    let mut own = servo();
    (own.kp, own.kd, own.lag, own.delay, own.offset) = (500.0, 100.0, 0.0, 0.1, 0.0);
    own.limit = 200.0;
    let mut arm = Arm::new(robot, vec![own; n]);
    arm.gravity_compensation = 1.0;
    for joint in &mut arm.joints {
        joint.armature = 1.0;
    }
    let time: Vec<f64> = (0..500).map(|k| 0.01 * f64::from(k)).collect();
    let held = |value: &dyn Fn(f64) -> f64| {
        let values = time.iter().map(|t| value(*t)).collect();
        Command::new(&time, values, Interpolation::Hold)
    };
    let with = |torque: f64| {
        let added = |j: usize| move |t: f64| if j == 1 && t >= 1.0 { torque } else { 0.0 };
        let track = Track {
            trajectory: 0,
            q: Array2::zeros((time.len(), n)),
            start_velocity: vec![0.0; n],
            commands: (0..n).map(|_| held(&|_| 0.0)).collect(),
            rates: None,
            added: Some((0..n).map(|j| held(&added(j))).collect()),
            time: time.clone(),
        };
        errors(&arm, &track).expect("stable")
    };
    let moved = with(5.0);
    // Nothing before the delay is over, and at rest the drive's own law holds against it.
    assert!(moved[109 * n + 1].abs() < 1e-12 && moved[112 * n + 1] > 1e-6);
    let end = moved[499 * n + 1];
    assert!((end - 5.0 / 500.0).abs() < 1e-5, "{end}");
    // Beyond the limit of the drive more torque changes nothing.
    let (much, more) = (with(1e4), with(2e4));
    assert!((much[130 * n + 1] - more[130 * n + 1]).abs() < 1e-12);
}

#[test]
fn a_long_step_adds_no_inertia() {
    let (mut arm, track) = example();
    let ends = |arm: &Arm, step: f64| {
        let mut arm = arm.clone();
        arm.step = step;
        errors(&arm, &track).expect("stable")
    };
    let rms = |a: &[f64], b: &[f64]| {
        let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
        (squares.sum::<f64>() / a.len() as f64).sqrt()
    };
    let (short, long) = (ends(&arm, 2.5e-4), ends(&arm, 4e-3));
    // Damping that acts at a step's end alone adds half of itself over the step: what this much inertia changes.
    for joint in 0..arm.dof() {
        let damping = arm.joints[joint].damping + arm.servos[joint].kd;
        arm.joints[joint].armature += 0.5 * 4e-3 * damping;
    }
    let heavier = ends(&arm, 2.5e-4);
    let (by_step, by_inertia) = (rms(&short, &long), rms(&short, &heavier));
    assert!(
        by_step < 0.2 * by_inertia,
        "the step changes {by_step:.2e} rad, its damping as inertia {by_inertia:.2e} rad"
    );
}
