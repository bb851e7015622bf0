use super::*;
use proptest::prelude::*;

const RATE: f64 = 62.5;

/// A gear with a gap under a load of several frequencies, its motor with friction and inertia; the departure follows the load.
fn rows(stiffness: f64, half: f64, zero: f64) -> Rows {
    let n = 4 * 900;
    let t = |i: usize| i as f64 / RATE;
    let of = |f: &dyn Fn(f64) -> f64| -> Vec<f64> { (0..n).map(|i| f(t(i))).collect() };
    let load = of(&|t| 8.0 * (1.1 * t).sin() + 5.0 * (3.7 * t).cos() + 2.0 * (0.3 * t).sin());
    let qd = of(&|t| 0.8 * (1.9 * t).cos() + 0.3 * (0.7 * t).sin());
    let qdd = of(&|t| -1.52 * (1.9 * t).sin() + 0.21 * (0.7 * t).cos());
    let sign: Vec<f64> = qd.iter().map(|v| (v / 0.01).tanh()).collect();
    let departure: Vec<f64> = load
        .iter()
        .map(|l| zero + l / stiffness + half * (l / 0.2).tanh())
        .collect();
    let rate = (0..n)
        .map(|i| {
            let (a, b) = (i.saturating_sub(1), (i + 1).min(n - 1));
            (departure[b] - departure[a]) * RATE / (b - a) as f64
        })
        .collect();
    let torque = (0..n)
        .map(|i| load[i] + 0.4 * qd[i] + 1.5 * sign[i] + 0.2 * qdd[i])
        .collect();
    Rows {
        departure,
        rate,
        motor: [qd, sign, qdd, vec![1.0; n]],
        own: of(&|t| (1.3 * t).sin()),
        turn: [
            of(&|t| (0.42 * (1.9 * t).sin()).sin()),
            of(&|t| (0.42 * (1.9 * t).sin()).cos()),
        ],
        torque,
        counts: vec![true; n],
        trajectories: (0..4).map(|k| k * 900..(k + 1) * 900).collect(),
        rate_hz: RATE,
    }
}

#[test]
fn a_spring_is_a_spring_and_its_stiffness_lies_in_its_interval() {
    let found = flanks(rows(2000.0, 0.0, 0.01)).unwrap();
    let [stiffness, std] = found.stiffness.unwrap();
    assert!((stiffness / 2000.0 - 1.0).abs() < 0.01, "{stiffness}");
    assert!(std < 0.06 * stiffness);
    assert!(found.half_gap.is_none());
    assert!((found.at[0] - 0.01).abs() < 1e-4 && found.at[0] == found.at[1]);
    assert!((found.inertia - 0.2).abs() < 0.01, "{}", found.inertia);
    assert!(found.explained > 0.99);
}

#[test]
fn a_gap_is_told_from_its_wind_up() {
    let found = flanks(rows(5000.0, 0.004, -0.02)).unwrap();
    let [half, std] = found.half_gap.unwrap();
    assert!((half - 0.004).abs() < 2.0 * std, "{half} ± {std}");
    assert!((found.stiffness.unwrap()[0] / 5000.0 - 1.0).abs() < 0.05);
    let [between, beyond] = found.parts;
    assert!(between > beyond, "{between} {beyond}");
    let middle = 0.5 * (found.at[0] + found.at[1]);
    assert!((middle + 0.02).abs() < 2e-4, "{middle}");
}

#[test]
fn a_departure_that_has_nothing_to_do_with_the_torque_explains_nothing() {
    let mut own = rows(2000.0, 0.0, 0.0);
    let mut state = 1u64;
    for x in &mut own.departure {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        *x = 1e-5 * ((state >> 40) as f64 / 16_777_216.0 - 0.5);
    }
    own.rate.fill(0.0);
    assert!(flanks(own).is_none());
}

/// Flanks too stiff for their deflection to be seen beneath the encoder's noise.
#[test]
fn a_gap_between_hard_flanks_is_seen_by_its_sides() {
    let mut own = rows(1e9, 0.004, -0.02);
    let mut other = rows(1e9, 0.0, 0.0);
    let mut state = 1u64;
    let mut noise = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        1e-4 * ((state >> 40) as f64 / 16_777_216.0 - 0.5)
    };
    own.departure.iter_mut().for_each(|x| *x += noise());
    other.departure.iter_mut().for_each(|x| *x += noise());
    let found = flanks(own.clone()).unwrap();
    let [half, std] = found.half_gap.unwrap();
    assert!(
        (half - 0.004).abs() < 2.0 * std && std < 4e-4,
        "{half} ± {std}"
    );
    assert!(((found.at[0] + found.at[1]) / 2.0 + 0.02).abs() < 2e-4);
    // Sides that the torque does not push to are no gap, nor is noise.
    own.torque.iter_mut().for_each(|x| *x = -*x);
    assert!(flanks(own).is_none());
    assert!(flanks(other).is_none());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// A joint that is counted the other way round has the same gear, with its flanks mirrored; another zero of its encoder moves
    /// the flanks and nothing else; torque in another unit scales the stiffness alone.
    #[test]
    fn direction_zero_and_unit_are_conventions(
        stiffness in 800.0f64..6000.0,
        half in prop_oneof![Just(0.0), 0.002f64..0.006],
        zero in -0.02f64..0.02,
        unit in 0.1f64..10.0,
    ) {
        let own = flanks(rows(stiffness, half, 0.0)).unwrap();
        let mut other = rows(stiffness, half, 0.0);
        for x in &mut other.departure {
            *x = zero - *x;
        }
        let negated = [&mut other.rate, &mut other.own, &mut other.torque];
        let motor = other.motor[..3].iter_mut();
        negated.into_iter().chain(motor).flatten().for_each(|x| *x = -*x);
        other.torque.iter_mut().for_each(|x| *x *= unit);
        other.own.iter_mut().for_each(|x| *x *= unit);
        let other = flanks(other).unwrap();
        let k = own.stiffness.unwrap()[0];
        let near = |a: f64, b: f64, most: f64| (a - b).abs() <= most;
        prop_assert!(near(other.stiffness.unwrap()[0] / unit, k, 2e-3 * k));
        prop_assert_eq!(own.half_gap.is_some(), other.half_gap.is_some());
        prop_assert_eq!(own.half_gap.is_some(), half > 0.0);
        if let (Some(a), Some(b)) = (own.half_gap, other.half_gap) {
            prop_assert!(near(a[0], b[0], 2e-3 * a[0]), "{:?} {:?}", a, b);
        }
        for (a, b) in own.at.iter().zip(other.at.iter().rev()) {
            prop_assert!(near(zero - b, *a, 1e-4), "{} {}", a, b);
        }
    }
}
