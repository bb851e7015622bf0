//! The check of a recording on recordings with one known fault each, and the order of sessions.

use crate::shared::shared;
use datasets::check::{CheckOptions, CheckReport, Kind, check};
use datasets::{Part, PrepareOptions, ReadOptions, Recording, Trajectory, prepare, read, repeats};
use ndarray::Array2;

/// Two joints at 100 Hz for 20 s in two trajectories.
fn good() -> Recording {
    let time: Vec<f64> = (0..2000)
        .map(|i| f64::from(i) * 0.01 + if i < 1000 { 0.0 } else { 5.0 })
        .collect();
    let q = Array2::from_shape_fn((2000, 2), |(i, j)| {
        let t = time[i];
        (1.7 * t + j as f64).sin() + 0.4 * (3.1 * t).cos()
    });
    let tau = q.mapv(|v| 20.0 * v + 3.0 * (9.0 * v).sin());
    let mut r = Recording::new("made", time, q, Some(tau));
    r.trajectories = vec![
        Trajectory {
            label: "a".into(),
            range: 0..1000,
        },
        Trajectory {
            label: "b".into(),
            range: 1000..2000,
        },
    ];
    r.validate().unwrap();
    r
}

fn report(r: &Recording, options: &CheckOptions) -> CheckReport {
    let o = PrepareOptions {
        cutoff_hz: Some(10.0),
        ..PrepareOptions::default()
    };
    check(r, &prepare(r, &o).unwrap(), options).unwrap()
}

fn kinds(r: &Recording) -> Vec<(Kind, Option<usize>)> {
    report(r, &CheckOptions::default())
        .findings
        .iter()
        .map(|f| (f.kind, f.joint))
        .collect()
}

#[test]
fn nothing_is_found_in_a_good_recording() {
    assert_eq!(kinds(&good()), []);
}

#[test]
fn each_fault_is_found_and_nothing_else() {
    let mut r = good();
    r.q.column_mut(1).fill(0.3);
    assert_eq!(kinds(&r), [(Kind::NeverMoves, Some(1))]);

    let mut r = good();
    r.q.column_mut(1).mapv_inplace(|q| 0.02 * q);
    let found = kinds(&r);
    assert!(
        found.contains(&(Kind::TooSlow, Some(1)))
            || found.contains(&(Kind::RegionTooSmall, Some(1)))
    );
    assert!(found.iter().all(|(_, j)| *j == Some(1)), "{found:?}");

    // The way of a joint that slides is in m.
    let sliding = CheckOptions {
        slides: vec![false, true],
        ..CheckOptions::default()
    };
    let words = |options: &CheckOptions| {
        let found = report(&r, options).findings;
        found.into_iter().map(|f| f.message).collect::<String>()
    };
    assert!(words(&CheckOptions::default()).contains(" rad"));
    assert!(!words(&sliding).contains("rad"), "{}", words(&sliding));

    let mut r = good();
    r.tau.as_mut().unwrap().column_mut(0).fill(0.0);
    assert_eq!(kinds(&r), [(Kind::DeadChannel, Some(0))]);

    let mut r = good();
    r.tau
        .as_mut()
        .unwrap()
        .column_mut(0)
        .mapv_inplace(|t| t.clamp(-15.0, 15.0));
    assert!(kinds(&r).contains(&(Kind::TorquePlateau, Some(0))));

    let mut r = good();
    r.q[(500, 1)] += 0.5;
    assert!(kinds(&r).contains(&(Kind::CorruptRow, Some(1))));
    // With its neighbours it is more than a hundredth of a short recording.
    let mut short = good().stretches(&[(0, 0..250)]);
    short.q[(120, 1)] += 0.5;
    assert!(kinds(&short).contains(&(Kind::CorruptRow, Some(1))));

    let mut r = good();
    r.time[300..1000].iter_mut().for_each(|t| *t += 0.05);
    assert!(kinds(&r).contains(&(Kind::ClockJump, None)));

    let mut r = good();
    r.qd = Some(r.q.mapv(|q| 57.0 * q.cos()));
    assert!(kinds(&r).iter().all(|(k, _)| *k == Kind::VelocityMismatch) && !kinds(&r).is_empty());

    let short = good().select(&[0]);
    let rows = 0..150;
    let cut = Recording {
        trajectories: vec![Trajectory {
            label: "a".into(),
            range: rows.clone(),
        }],
        ..Recording::new(
            "short",
            short.time[rows.clone()].to_vec(),
            short
                .q
                .select(ndarray::Axis(0), &rows.clone().collect::<Vec<_>>()),
            None,
        )
    };
    assert!(kinds(&cut).contains(&(Kind::TooShort, Some(0))));
}

#[test]
fn repeats_are_found_from_the_motion_and_give_the_noise() {
    // The second trajectory repeats the first under another label; torques differ by ±0.5.
    let mut r = good();
    for i in 0..1000 {
        for j in 0..2 {
            r.q[(1000 + i, j)] = r.q[(i, j)];
            let tau = r.tau.as_mut().unwrap();
            tau[(1000 + i, j)] = tau[(i, j)] + if i % 2 == 0 { 0.5 } else { -0.5 };
        }
    }
    assert_eq!(repeats::find(&r), [(0, 1)]);
    let floor = report(&r, &CheckOptions::default()).repeatability.unwrap();
    assert!(
        (floor.all[0] - 0.5 / 2.0_f64.sqrt()).abs() < 1e-6,
        "{floor:?}"
    );
    assert!(repeats::find(&good()).is_empty());
}

#[test]
fn repeats_of_shared_recordings() {
    let Some(data) = shared("data/kr300") else {
        return;
    };
    let kr300 = |f: &str| read(&data.join(f), &ReadOptions::kr300(Part::Train)).unwrap();
    let (train, test) = (kr300("train.parquet"), kr300("test.parquet"));
    assert_eq!(repeats::find(&train).len(), 33);
    assert_eq!(repeats::find(&test), [(0, 3), (1, 4), (2, 5)]);
}

/// Commanded motion as a controller's position follows it, and as logs spoil it.
#[test]
fn a_command_of_another_unit_or_time_is_named() {
    let follow = |gain: f64, late: f64| {
        let mut r = good();
        let motion = |t: f64, j: usize| (1.7 * t + j as f64).sin() + 0.4 * (3.1 * t).cos();
        r.q_ref = Some(Array2::from_shape_fn((2000, 2), |(i, j)| {
            motion(r.time[i] + late, j) / gain
        }));
        kinds(&r)
    };
    for late in [0.0, 0.05, 0.2] {
        assert_eq!(follow(1.0, late), [], "{late}");
    }
    for (gain, late) in [
        (180.0 / std::f64::consts::PI, 0.0),
        (std::f64::consts::PI / 180.0, 0.02),
        (1000.0, 0.0),
        (1.0, 0.7),
        (1.0, 1.4),
        (1.0, -0.3),
    ] {
        assert_eq!(follow(gain, late), [(Kind::Command, None)], "{gain} {late}");
    }
    let both = follow(180.0 / std::f64::consts::PI, 0.7);
    assert_eq!(both, [(Kind::Command, None); 2]);
}

/// How well a robot repeats itself, by the periods of one long trajectory.
#[test]
fn periods_within_a_trajectory_give_the_spread() {
    let spread = |period: f64, drift: f64| {
        let time: Vec<f64> = (0..5000).map(|i| f64::from(i) * 0.005).collect();
        let w = std::f64::consts::TAU / period;
        let q = Array2::from_shape_fn((5000, 2), |(i, j)| {
            (w * time[i] + j as f64).sin() + 0.3 * (3.0 * w * time[i]).cos()
        });
        let tau = Array2::from_shape_fn((5000, 2), |(i, j)| {
            10.0 * q[(i, j)] + drift * (0.11 * std::f64::consts::TAU * time[i]).sin()
        });
        repeats::spread(&Recording::new("made", time, q, Some(tau)))
    };
    for period in [4.0, 7.3, 10.0] {
        let same = spread(period, 0.0).unwrap();
        assert!(same.iter().all(|s| *s < 0.1), "{period}: {same:?}");
        let drifting = spread(period, 2.0).unwrap();
        assert!(
            drifting.iter().all(|s| (0.3..3.0).contains(s)),
            "{period}: {drifting:?}"
        );
    }
    // Less than a period is repeated nowhere.
    assert_eq!(spread(40.0, 0.0), None);
}
