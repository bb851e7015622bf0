//! Limits: what cannot hold is refused, and what is asked holds at all times.

use super::*;
use proptest::prelude::*;

#[test]
fn what_cannot_hold_is_refused_with_the_reason() {
    let new = |l: MotionLimits, period| {
        Room::new(Bounds::of(vec![LIMITS, l]), period, &[1, 2, 3], 1).unwrap_err()
    };
    let flat = MotionLimits {
        lower: 1.0,
        upper: 1.0,
        ..LIMITS
    };
    assert_eq!(new(flat, 12.5), ExcitationError::NoRoom { joint: 1 });
    // 0.15 rad there and back at 0.02 rad/s take 15 s.
    let slow = MotionLimits {
        velocity: 0.02,
        ..LIMITS
    };
    match new(slow, 12.5) {
        ExcitationError::TooSlow {
            joint: 1,
            limit: "velocity",
            enough,
            ..
        } => assert!((enough - 15.0).abs() < 1e-9),
        other => panic!("{other}"),
    }
    let sluggish = MotionLimits {
        acceleration: 1e-3,
        ..LIMITS
    };
    assert!(matches!(
        new(sluggish, 12.5),
        ExcitationError::TooSlow {
            limit: "acceleration",
            ..
        }
    ));
    let gentle = MotionLimits {
        jerk: 1e-4,
        ..LIMITS
    };
    assert!(matches!(
        new(gentle, 12.5),
        ExcitationError::TooSlow { limit: "jerk", .. }
    ));
    assert_eq!(new(LIMITS, 0.0), ExcitationError::Empty("the period"));
    let one = Room::new(Bounds::of(vec![LIMITS]), 5.0, &[1], 1).unwrap_err();
    assert!(matches!(
        one,
        ExcitationError::FewHarmonics { needed: 2, .. }
    ));
    let away = Bounds {
        home: Some(vec![1.5]),
        ..Bounds::of(vec![LIMITS])
    };
    let outside = Room::new(away, 5.0, &[1, 2], 1).unwrap_err();
    assert!(matches!(
        outside,
        ExcitationError::HomeOutside { joint: 0, .. }
    ));
    assert!(Room::new(Bounds::of(Vec::new()), 5.0, &[1, 2], 1).is_err());
    let robot = Robot::builtin("ur5").unwrap();
    let base = BaseParameters::of_robot(&robot, &EXTRAS);
    let rows = BaseRows::new(&robot, &base, &EXTRAS);
    assert!(Excitation::new(rows, Criterion::Condition, vec![1.0; 5], 60).is_err());
}

/// Favard's bounds are attained: a triangle wave's range is v T/2, that of parabolas a T²/16, and a sine stays below.
#[test]
fn the_farthest_stroke_is_that_of_bang_bang_motion() {
    let limits = |velocity: f64, acceleration: f64, jerk: f64| MotionLimits {
        lower: -1.0,
        upper: 1.0,
        velocity,
        acceleration,
        jerk,
    };
    // A twentieth of the range is 0.1.
    let (t, big) = (2.0, 1e6);
    assert!(limits(0.1001, big, big).reachable(0, t).is_ok());
    assert!(limits(0.0999, big, big).reachable(0, t).is_err());
    assert!(limits(big, 0.4001, big).reachable(0, t).is_ok());
    assert!(limits(big, 0.3999, big).reachable(0, t).is_err());
    // 0.05 sin(ω t) needs 0.05 ω³ of jerk; the best motion needs less.
    let sine = 0.05 * PI.powi(3);
    assert!(limits(big, big, sine).reachable(0, t).is_ok());
    assert!(limits(big, big, 1.1999).reachable(0, t).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    /// Whatever the coefficients, on a grid twenty times as fine as the one that they were kept by.
    #[test]
    fn limits_rest_and_home_hold_whatever_is_asked(
        values in prop::collection::vec(-3.0..3.0f64, 2 * (1 + 12)),
        lower in -3.0..-0.1f64,
        upper in 0.1..3.0f64,
        velocity in 0.3..4.0f64,
        acceleration in 0.5..20.0f64,
        jerk in 3.0..200.0f64,
        rest in 0..3usize,
        home in prop::option::of(-0.1..0.1f64),
        highest in 6..20usize,
    ) {
        let limits = vec![MotionLimits { lower, upper, velocity, acceleration, jerk }; 2];
        let bounds = Bounds {
            limits: limits.clone(),
            rest: [Rest::Velocity, Rest::Acceleration, Rest::Jerk][rest],
            home: home.map(|h| vec![h; 2]),
            tool: None,
        };
        let harmonics = [1, 2, 3, 4, 5, highest];
        let room = Room::new(bounds, 10.0, &harmonics, 1).unwrap();
        let mut t = model_free(&room, 7);
        for j in 0..2 {
            t.offset[j] = values[13 * j];
            for i in 0..6 {
                t.sine[(j, i)] = values[13 * j + 1 + i];
                t.cosine[(j, i)] = values[13 * j + 7 + i];
            }
        }
        room.keep(&mut t);
        prop_assert!(excess(&t, &limits, 20 * 24 * highest) < 1e-9);
        for end in [0.0, t.duration] {
            let s = state(&t, end);
            for j in 0..2 {
                prop_assert!(s.qd[j].abs() < 1e-9);
                prop_assert!(rest < 1 || s.qdd[j].abs() < 1e-8);
                prop_assert!(rest < 2 || s.qddd[j].abs() < 1e-7);
                prop_assert!(home.is_none_or(|h| (s.q[j] - h).abs() < 1e-9));
            }
        }
        // Kept once, it is kept.
        let mut again = t.clone();
        room.keep(&mut again);
        let change = (&again.sine - &t.sine).iter().fold(0.0f64, |m, x| m.max(x.abs()));
        prop_assert!(change < 1e-9);
    }
}
