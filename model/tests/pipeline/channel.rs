//! Delay, scale, offset and sign of a torque channel, on recordings of a UR5 that are known.

use datasets::channel::{ChannelEstimate, Estimate95};
use datasets::{PrepareOptions, Recording, prepare};
use model::physics_fit::{FitOptions, fit_physics};
use model::preparation::channel::{certain_delay, estimate};
use ndarray::Array2;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::Robot;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const RATE: f64 = 125.0;
const SAMPLES: usize = 2500;

/// Position, velocity and acceleration of one joint at time t.
fn motion(joint: usize, t: f64) -> [f64; 3] {
    let j = joint as f64;
    let waves = [
        (0.6, 0.9 + 0.17 * j, j),
        (0.35, 2.3 + 0.31 * j, 2.0 * j),
        (0.12, 5.1 - 0.43 * j, 0.7 * j),
    ];
    let [q, v, a] = waves.iter().fold([0.0; 3], |[q, v, a], &(size, w, phase)| {
        let (s, c) = (w * t + phase).sin_cos();
        [q + size * s, v + size * w * c, a - size * w * w * s]
    });
    [q + [0.0, -1.2, 1.0, -0.6, 0.5, 0.0][joint], v, a]
}

/// Torque of the built-in UR5 with friction, `delay` s behind, times `gain`, with noise; positions in encoder counts.
fn recording(delay: f64, gain: [f64; 6], seed: u64) -> Recording {
    let robot = Robot::builtin("ur5").unwrap();
    let mut workspace = Workspace::new(&robot);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let time: Vec<f64> = (0..SAMPLES).map(|k| k as f64 / RATE).collect();
    let mut q = Array2::zeros((SAMPLES, 6));
    let mut tau = Array2::zeros((SAMPLES, 6));
    for (k, &t) in time.iter().enumerate() {
        let then: Vec<[f64; 3]> = (0..6).map(|j| motion(j, t - delay)).collect();
        let of = |i: usize| -> Vec<f64> { then.iter().map(|s| s[i]).collect() };
        let mut torque = vec![0.0; 6];
        inverse_dynamics(&robot, &mut workspace, &of(0), &of(1), &of(2), &mut torque);
        for j in 0..6 {
            let v = then[j][1];
            let friction = 2.0 * v / v.hypot(0.01) + 3.0 * v;
            let noise = 0.4 * random.random_range(-1.0..1.0);
            tau[(k, j)] = gain[j] * (torque[j] + friction + noise);
            q[(k, j)] = (motion(j, t)[0] / 1e-4).round() * 1e-4;
        }
    }
    Recording::new("made", time, q, Some(tau))
}

fn found(recording: &Recording) -> ChannelEstimate {
    let prepared = prepare(recording, &PrepareOptions::default()).unwrap();
    estimate(&Robot::builtin("ur5").unwrap(), recording, &prepared)
}

fn holds(estimate: &Estimate95, truth: f64, widest: f64) -> bool {
    estimate
        .interval
        .is_some_and(|[a, b]| (a..=b).contains(&truth) && b - a < widest)
}

#[test]
fn a_scale_is_found_beside_friction_and_noise() {
    // Plain regression on the model's torque made 0.25 of 0.59, and a scale of a joint that carries nothing.
    let gain = [1.0, 0.59, 1.0, -1.0, 1.0, 6.0];
    let channel = found(&recording(0.0, gain, 1));
    let scale = |j: usize| channel.joints[j].scale;
    assert!(holds(&scale(1), 0.59, 0.12), "{:?}", scale(1));
    assert!(holds(&scale(2), 1.0, 0.2), "{:?}", scale(2));
    assert!(holds(&scale(3), -1.0, 0.6), "{:?}", scale(3));
    assert_eq!(
        [1, 2, 3].map(|j| channel.joints[j].sign),
        [Some(1), Some(1), Some(-1)]
    );
    // The last joint turns a flange of next to no inertia against friction: no scale, or one that holds the truth.
    assert!(
        scale(5) == Estimate95::NONE || holds(&scale(5), 6.0, 20.0),
        "{:?}",
        scale(5)
    );
}

#[test]
fn a_delay_is_found_with_its_interval_and_said_only_where_it_is_certain() {
    let names = Robot::builtin("ur5").unwrap().joint_names();
    for delay in [-0.011, 0.0, 0.023] {
        let channel = found(&recording(delay, [1.0; 6], 2));
        assert!(
            holds(&channel.delay, delay, 0.006),
            "{delay}: {:?}",
            channel.delay
        );
        assert_eq!(
            channel.findings(&names).len(),
            usize::from(delay != 0.0),
            "{delay}"
        );
    }
}

#[test]
fn nothing_is_said_of_a_torque_that_has_nothing_to_do_with_the_motion() {
    // The error is flat over all delays: an end of the search is no estimate.
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut made = recording(0.0, [1.0; 6], 3);
    if let Some(tau) = &mut made.tau {
        tau.mapv_inplace(|_| random.random_range(-1.0..1.0));
    }
    let channel = found(&made);
    assert!(
        channel.findings(&[]).iter().all(|f| f.joint.is_some()),
        "{channel:?}"
    );
    if let Some([low, high]) = channel.delay.interval {
        assert!(low < 0.0 && high > 0.0, "{:?}", channel.delay);
    }
    made.tau = None;
    assert_eq!(found(&made), ChannelEstimate::unknown(6));
}

/// A torque that is late for certain is late in the fit and in the scores, and nowhere else.
#[test]
fn a_certain_delay_belongs_to_the_model() {
    let robot = Robot::builtin("ur5").unwrap();
    let options = PrepareOptions::low_passed(10.0);
    let delay = |recording: &Recording| {
        certain_delay(&robot, std::slice::from_ref(recording), &options).unwrap()
    };
    assert_eq!(delay(&recording(0.0, [1.0; 6], 4)), None);
    let (late, test) = (recording(0.02, [1.0; 6], 5), recording(0.02, [1.0; 6], 6));
    assert!(holds(&delay(&late).unwrap(), 0.02, 0.01));
    let settings = FitOptions {
        prepare: options,
        ..FitOptions::default()
    };
    let fit = fit_physics(&robot, std::slice::from_ref(&late), Some(&test), &settings).unwrap();
    let stored = fit.file.preprocessing.torque_delay.unwrap();
    assert!(holds(&stored, 0.02, 0.01), "{stored:?}");
    assert_eq!(
        Some(fit.file.preprocessing.options(None).torque_delay),
        stored.value
    );
    // Noise of 0.4 N·m, uniform: 0.23 N·m. Without the delay it is several times that.
    let rows = fit.rows(1, &test).unwrap();
    let physics = rows.iter().find(|r| r.name == "physics").unwrap();
    let worst = physics
        .scores
        .rmse
        .iter()
        .flatten()
        .copied()
        .fold(0.0, f64::max);
    assert!(worst < 0.4, "{:?}", physics.scores.rmse);
}
