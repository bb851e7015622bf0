//! On a robot whose law is known: what is learned of it, and whether its motion comes back from its torque.

use super::law::{Derived, JointFriction, Law};
use super::solve::Trajectory;
use super::{InversionError, MotionPrior};
use datasets::{Recording, Trajectory as Rows};
use ndarray::Array2;
use physics::robot::Robot;
use physics::torque_model::TorqueModel;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

const SAMPLES: usize = 200;
const RATE_HZ: f64 = 10.0;
const SHAPES: usize = 3;

fn law() -> Law {
    let robot = Robot::builtin("ur5").unwrap();
    let own = robot.parameters();
    let model = TorqueModel::new(&robot, &own, &own, vec![Vec::new(); robot.dof()]).unwrap();
    let friction = JointFriction {
        parameters: [0.2, 0.5, 3.0, 2.0, 1.0],
        speed: 0.3,
        moving: 0.1,
        standing: 3.0,
    };
    Law::new(&model, vec![friction; robot.dof()])
}

/// Position, velocity and acceleration of each joint at a sample: sums of shapes that start and end at rest.
fn motion(coefficients: &[f64], sample: usize) -> [Vec<f64>; 3] {
    let (t, whole) = (sample as f64 / RATE_HZ, (SAMPLES - 1) as f64 / RATE_HZ);
    let joints = coefficients.chunks(SHAPES);
    let mut all = [vec![], vec![], vec![]];
    for own in joints {
        let mut value = [0.0; 3];
        for (k, c) in own.iter().enumerate() {
            let w = 2.0 * PI * (k + 1) as f64 / whole;
            value[0] += c * (1.0 - (w * t).cos());
            value[1] += c * w * (w * t).sin();
            value[2] += c * w * w * (w * t).cos();
        }
        all.iter_mut().zip(value).for_each(|(a, v)| a.push(v));
    }
    all
}

fn draw(random: &mut ChaCha8Rng) -> Vec<f64> {
    (0..6 * SHAPES)
        .map(|_| random.random_range(-0.5..0.5))
        .collect()
}

/// So many trajectories, with their velocities.
fn recording(trajectories: usize, random: &mut ChaCha8Rng) -> (Recording, Array2<f64>) {
    let rows = trajectories * SAMPLES;
    let (mut q, mut qd) = (Array2::zeros((rows, 6)), Array2::zeros((rows, 6)));
    for trajectory in 0..trajectories {
        let coefficients = draw(random);
        for sample in 0..SAMPLES {
            let [position, velocity, _] = motion(&coefficients, sample);
            for joint in 0..6 {
                q[[trajectory * SAMPLES + sample, joint]] = position[joint] + 0.1;
                qd[[trajectory * SAMPLES + sample, joint]] = velocity[joint];
            }
        }
    }
    let time = (0..rows).map(|k| k as f64 / RATE_HZ).collect();
    let mut recording = Recording::new("made", time, q, None);
    recording.trajectories = (0..trajectories)
        .map(|k| Rows {
            label: k.to_string(),
            range: k * SAMPLES..(k + 1) * SAMPLES,
        })
        .collect();
    (recording, qd)
}

#[test]
fn derivatives_are_those_of_the_torque() {
    let law = law();
    let mut at = Derived::new(law.robot());
    let torque = |x: &[f64]| {
        let mut at = Derived::new(law.robot());
        law.derive(&x[..6], &x[6..12], &x[12..], 0.2, &mut at);
        at.torque
    };
    let x: Vec<f64> = (0..18).map(|k| (f64::from(k) * 1.7).sin()).collect();
    law.derive(&x[..6], &x[6..12], &x[12..], 0.2, &mut at);
    for (place, table) in at.by.iter().enumerate() {
        for joint in 0..6 {
            let moved = |by: f64| {
                let mut x = x.clone();
                x[6 * place + joint] += by;
                torque(&x)
            };
            let (low, high) = (moved(-1e-4), moved(1e-4));
            for i in 0..6 {
                let expected = (high[i] - low[i]) / 2e-4;
                let found = table[i * 6 + joint];
                assert!(
                    (found - expected).abs() < 1e-4 * (1.0 + expected.abs()),
                    "{place} {joint} {i}: {found} {expected}"
                );
            }
        }
    }
}

#[test]
fn as_many_shapes_as_the_motions_are_made_of() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let (data, qd) = recording(12, &mut random);
    let prior = MotionPrior::learn(&[(&data, &qd)]).unwrap();
    assert_eq!((prior.shapes.len(), prior.samples()), (SHAPES, SAMPLES));
    // All start at rest.
    assert_eq!(prior.standing[0], 1.0);
    assert!(prior.standing[SAMPLES / 3] < 0.3);
    assert!(prior.covers(&data));
    let mut slower = data.clone();
    slower.time.iter_mut().for_each(|t| *t *= 1.1);
    assert!(!prior.covers(&slower));
    // One joint of 12 trajectories that only ever rests.
    let mut still = data.clone();
    still.q.column_mut(2).fill(0.3);
    assert!(matches!(
        MotionPrior::learn(&[(&still, &qd)]),
        Err(InversionError::Still)
    ));
    // Two trajectories are as many motions of joints as it takes for three shapes; one is too few.
    let (few, qd) = recording(1, &mut random);
    assert!(matches!(
        MotionPrior::learn(&[(&few, &qd)]),
        Err(InversionError::TooFew {
            shapes: SHAPES,
            needed: 2,
            ..
        })
    ));
}

#[test]
fn motion_comes_back_from_its_torque() {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let (data, qd) = recording(12, &mut random);
    let prior = MotionPrior::learn(&[(&data, &qd)]).unwrap();
    let shapes = prior.sampled().unwrap();
    let law = law();
    // A motion that was not learned from, and torque with an error as large as the law says.
    let coefficients = draw(&mut random);
    let mut at = Derived::new(law.robot());
    let (mut q, mut torque) = (Array2::zeros((SAMPLES, 6)), Array2::zeros((SAMPLES, 6)));
    for sample in 0..SAMPLES {
        let [p, v, a] = motion(&coefficients, sample);
        law.derive(&p, &v, &a, super::law::SOFTNESS, &mut at);
        for joint in 0..6 {
            q[[sample, joint]] = p[joint];
            torque[[sample, joint]] = at.torque[joint] + random.random_range(-0.15..0.15);
        }
    }
    let start = q.row(0).to_vec();
    let trajectory = Trajectory {
        law: &law,
        prior: &prior,
        shapes: &shapes,
        torque: torque.view(),
        start: &start,
        cancel: &AtomicBool::new(false),
    };
    let found = trajectory.solve();
    let worst = (&found.q - &q).iter().fold(0.0_f64, |w, e| w.max(e.abs()));
    let way = q.iter().fold(0.0_f64, |w, e| w.max(e.abs()));
    assert!(worst < 0.02 && way > 1.0, "off by {worst} rad of {way}");
}
