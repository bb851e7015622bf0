//! What a motion is foretold to show is what a diagnosis of it finds.

use crate::case::{Case, URDF, causes, rubbing};
use diagnose::{Effect, Settings, visible};
use ndarray::Array2;
use physics::robot::Robot;
use signal::Motion;

/// The motion of [`rubbing`] without shift.
fn motion(trajectories: u32, samples: u32) -> Motion {
    let state = |row: usize| {
        let (a, t) = (
            f64::from(row as u32 / samples),
            f64::from(row as u32 % samples) * 0.008,
        );
        let (w1, w2) = (1.7 + 0.1 * a, 3.9 - 0.13 * a);
        let (x, y) = (w1 * t + a, w2 * t);
        [
            0.6 * x.sin() + 0.3 * y.sin(),
            0.6 * w1 * x.cos() + 0.3 * w2 * y.cos(),
            -0.6 * w1 * w1 * x.sin() - 0.3 * w2 * w2 * y.sin(),
        ]
    };
    let rows = (trajectories * samples) as usize;
    let table = |k: usize| Array2::from_shape_fn((rows, 1), |(i, _)| state(i)[k]);
    let each = samples as usize;
    Motion {
        time: (0..rows).map(|i| (i % each) as f64 * 0.008).collect(),
        q: table(0),
        qd: table(1),
        qdd: table(2),
        segments: (0..trajectories as usize)
            .map(|k| k * each..(k + 1) * each)
            .collect(),
    }
}

#[test]
fn an_effect_is_found_above_its_size_and_not_below() {
    let robot = Robot::from_urdf_str(URDF).unwrap();
    // The recording's noise is even over ±0.002 N·m.
    let noise = [0.004 / 12f64.sqrt()];
    let all = visible(
        &robot,
        &motion(6, 1500),
        &noise,
        &Settings::default(),
        &|_, _| (),
    );
    let stribeck = all
        .iter()
        .find(|v| v.effect == Effect::StribeckFriction)
        .unwrap();
    let from = stribeck.from.unwrap();
    assert!(from > 0.001 && from < 0.3, "{stribeck:?}");
    let [velocity, exponent] = [0, 1].map(|k| stribeck.shape[k].value);
    let found = |size: f64| {
        let friction = |qd: f64| {
            let falling = size * (-(qd.abs() / velocity).powf(exponent)).exp();
            0.4 * qd + (0.3 + falling) * qd.signum()
        };
        let case = Case::new(
            &rubbing(friction, 0.0, 6, 1500),
            &rubbing(friction, 0.5, 6, 1500),
        );
        let report = case.report(&["--fast"]);
        causes(&report).contains(&"stribeck_friction")
    };
    assert!(found(3.0 * from), "{stribeck:?}");
    assert!(!found(from / 3.0), "{stribeck:?}");
}

#[test]
fn noise_and_standstill_hide_effects() {
    let robot = Robot::from_urdf_str(URDF).unwrap();
    let settings = Settings::default();
    let from = |motion: &Motion, noise: f64, effect: Effect| {
        let all = visible(&robot, motion, &[noise], &settings, &|_, _| ());
        all.iter().find(|v| v.effect == effect).and_then(|v| v.from)
    };
    let quick = motion(4, 1000);
    let [quiet, loud] = [0.001, 1.0].map(|n| from(&quick, n, Effect::RotorInertia).unwrap());
    assert!(loud > 2.0 * quiet, "{quiet} {loud}");
    let mut still = motion(4, 1000);
    still.qd.fill(0.0);
    still.qdd.fill(0.0);
    still.q.fill(0.3);
    assert_eq!(from(&still, 0.001, Effect::RotorInertia), None);
    assert_eq!(from(&still, 0.001, Effect::StribeckFriction), None);
}
