//! Preprocessing against motions whose derivatives are known, and on the shared recordings.

use crate::shared::shared;
use datasets::prepare::{Derivatives, PrepareError, Source};
use datasets::{
    Part, PrepareOptions, ReadOptions, Recording, TorqueFilter, Trajectory, prepare, read,
};
use ndarray::{Array1, Array2};
use std::f64::consts::PI;

/// Multi-sine with harmonics that fall off, as an identification run has: q, qd, qdd at t.
fn motion(t: f64, phase: f64) -> [f64; 3] {
    let mut out = [0.0; 3];
    for k in 1..=12 {
        let (k, w) = (f64::from(k), 2.0 * PI * 0.2 * f64::from(k));
        let a = 0.8 / (1.0 + k * k * 0.2);
        let x = w * t + phase * k;
        out[0] += a * x.sin();
        out[1] += a * w * x.cos();
        out[2] -= a * w * w * x.sin();
    }
    out
}

/// White noise of unit variance, uniform (splitmix64).
fn noise(i: usize) -> f64 {
    let mut x = (i as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^= x >> 31;
    ((x >> 11) as f64 / (1u64 << 53) as f64 - 0.5) * 12.0_f64.sqrt()
}

/// Two trajectories of 15 s at 250 Hz with position noise `sigma` and velocity noise `sigma_v`.
fn noisy(sigma: f64, sigma_v: Option<f64>) -> (Recording, Vec<[f64; 3]>) {
    let time: Vec<f64> = (0..3750)
        .map(|i| f64::from(i) * 0.004)
        .chain((0..3750).map(|i| 17.0 + f64::from(i) * 0.004))
        .collect();
    let truth: Vec<[f64; 3]> = time.iter().map(|&t| motion(t, 0.7)).collect();
    let column = |k: usize, s: f64, seed: usize| {
        let values = truth
            .iter()
            .enumerate()
            .map(|(i, x)| x[k] + s * noise(i + seed));
        Array1::from_iter(values).insert_axis(ndarray::Axis(1))
    };
    let mut r = Recording::new("synthetic", time, column(0, sigma, 0), None);
    r.qd = sigma_v.map(|s| column(1, s, 100_000));
    r.trajectories = vec![
        Trajectory {
            label: "a".into(),
            range: 0..3750,
        },
        Trajectory {
            label: "b".into(),
            range: 3750..7500,
        },
    ];
    r.validate().unwrap();
    (r, truth)
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0), |(s, n), v| (s + v * v, n + 1));
    (sum / f64::from(n)).sqrt()
}

/// RMS error of acceleration, half a second at each end of a trajectory left out.
fn acceleration_error(r: &Recording, truth: &[[f64; 3]], options: &PrepareOptions) -> f64 {
    let p = prepare(r, options).unwrap();
    let inside = p
        .at_samples
        .segments
        .iter()
        .flat_map(|s| s.start + 125..s.end - 125);
    rms(inside.map(|row| p.at_samples.qdd[(row, 0)] - truth[row][2]))
}

#[test]
fn accelerations_hold_up_to_the_ends() {
    // The last tenth of a second is worse than the rest, but an acceleration still.
    let (r, truth) = noisy(1e-5, None);
    let p = prepare(&r, &PrepareOptions::default()).unwrap();
    let ends = p
        .at_samples
        .segments
        .iter()
        .flat_map(|s| (s.start..s.start + 25).chain(s.end - 25..s.end));
    let error = rms(ends.map(|row| p.at_samples.qdd[(row, 0)] - truth[row][2]));
    let deviation = rms(truth.iter().map(|x| x[2]));
    println!("error at the ends {error:.3} of {deviation:.1} rad/s²");
    assert!(error < 0.1 * deviation, "{error} {deviation}");
}

#[test]
fn the_chosen_cutoff_is_close_to_the_best_one() {
    for sigma in [1e-6, 1e-5, 1e-4] {
        let (r, truth) = noisy(sigma, None);
        let chosen = prepare(&r, &PrepareOptions::default())
            .unwrap()
            .report
            .cutoff_hz
            .unwrap();
        let error = acceleration_error(&r, &truth, &PrepareOptions::default());
        let best = [2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0]
            .into_iter()
            .map(|hz| {
                let o = PrepareOptions {
                    cutoff_hz: Some(hz),
                    ..PrepareOptions::default()
                };
                acceleration_error(&r, &truth, &o)
            })
            .fold(f64::INFINITY, f64::min);
        println!("noise {sigma:.0e} rad: {chosen:.1} Hz, error {error:.4}, best {best:.4} rad/s²");
        assert!(error < 1.3 * best, "{sigma}: {error} {best} at {chosen} Hz");
        let deviation = rms(truth.iter().map(|x| x[2]));
        assert!(error < 0.01 * deviation, "{error} of {deviation}");
    }
}

#[test]
fn a_less_noisy_velocity_is_fused_and_lowers_the_error() {
    let (r, truth) = noisy(1e-3, Some(2e-3));
    let alone = PrepareOptions {
        derivatives: Derivatives::FromPosition,
        ..PrepareOptions::default()
    };
    let p = prepare(&r, &PrepareOptions::default()).unwrap();
    assert_eq!(p.report.velocity, [Source::Fused]);
    assert_eq!(p.report.acceleration, Source::Derived);
    let (fused, position) = (
        acceleration_error(&r, &truth, &PrepareOptions::default()),
        acceleration_error(&r, &truth, &alone),
    );
    println!("acceleration error: fused {fused:.4}, position alone {position:.4} rad/s²");
    assert!(fused < 0.7 * position, "{fused} {position}");
}

#[test]
fn a_noisier_or_foreign_velocity_is_replaced() {
    let (r, _) = noisy(1e-6, Some(1e-2));
    assert_eq!(
        prepare(&r, &PrepareOptions::default())
            .unwrap()
            .report
            .velocity,
        [Source::Replaced]
    );
    // Quiet, but 10 % too large: not the derivative of this position.
    let (mut r, _) = noisy(2e-4, Some(1e-3));
    r.qd.as_mut().unwrap().mapv_inplace(|v| 1.1 * v);
    assert_eq!(
        prepare(&r, &PrepareOptions::default())
            .unwrap()
            .report
            .velocity,
        [Source::Replaced]
    );
}

#[test]
fn recorded_derivatives_are_taken_where_asked_for() {
    let (r, _) = noisy(1e-5, Some(1e-2));
    let o = PrepareOptions {
        derivatives: Derivatives::Recorded,
        ..PrepareOptions::default()
    };
    let p = prepare(&r, &o).unwrap();
    assert_eq!(p.report.velocity, [Source::Recorded]);
    assert_eq!(Some(&p.at_samples.qd), r.qd.as_ref());
}

#[test]
fn slow_recordings_are_interpolated_and_columns_come_back_through_the_torque_filter() {
    let time: Vec<f64> = (0..600).map(|i| f64::from(i) * 0.1).collect();
    let q = Array2::from_shape_fn((600, 1), |(i, _)| motion(time[i], 0.7)[0]);
    let mut r = Recording::new("slow", time.clone(), q, None);
    let plain = prepare(&r, &PrepareOptions::default()).unwrap();
    assert_eq!(plain.report.cutoff_hz, None);
    assert!((plain.report.fine_hz - 100.0).abs() < 1e-6);
    // Interpolation: positions are kept, accelerations are those of the motion.
    for (a, b) in plain.at_samples.q.iter().zip(&r.q) {
        assert!((a - b).abs() < 1e-12);
    }
    let error = rms(plain
        .fine
        .qdd
        .iter()
        .zip(&plain.fine.time)
        .map(|(a, &t)| a - motion(t, 0.7)[2]));
    let deviation = rms(time.iter().map(|&t| motion(t, 0.7)[2]));
    assert!(error < 0.05 * deviation, "{error} {deviation}");
    // A column of the fine grid comes back at the stamps as it is …
    let column: Vec<f64> = plain
        .fine
        .time
        .iter()
        .map(|&t| motion(t, 0.7)[1].signum())
        .collect();
    let back = plain.to_samples(&column);
    for (b, &t) in back.iter().zip(&time) {
        assert!((b - motion(t, 0.7)[1].signum()).abs() < 1e-6);
    }
    // … and with a torque filter like SciPy's sosfiltfilt on the fine grid: a step through a
    // 2 Hz low-pass passes its middle at the step and overshoots by less than a third.
    r.torque_filter = Some(TorqueFilter::KR300);
    let filtered = prepare(&r, &PrepareOptions::default()).unwrap();
    let step: Vec<f64> = filtered
        .fine
        .time
        .iter()
        .map(|&t| f64::from(u8::from(t > 30.0)))
        .collect();
    let back = filtered.to_samples(&step);
    assert!(
        (back[300] - 0.5).abs() < 0.1 && back[280].abs() < 0.1 && (back[320] - 0.955).abs() < 0.1
    );
    assert!(back.iter().all(|v| (-0.3..1.3).contains(v)));
}

/// Stamps in microseconds, and a clock that is set while it records, have grids beyond memory: both are refused.
#[test]
fn stamps_that_are_no_seconds_are_refused() {
    let (good, _) = noisy(1e-5, None);
    let options = PrepareOptions::default();
    let mut fast = good.clone();
    fast.time.iter_mut().for_each(|t| *t *= 1e6);
    let refused = prepare(&fast, &options).unwrap_err();
    assert!(matches!(refused, PrepareError::Clock { .. }), "{refused}");
    assert!(refused.advice().contains("units.time"), "{refused}");
    let mut set = good;
    set.time[3760..].iter_mut().for_each(|t| *t += 1.7e9);
    let Err(PrepareError::Clock { row, label, .. }) = prepare(&set, &options) else {
        panic!("a clock that was set");
    };
    assert_eq!((row, label.as_str()), (3761, "b"));
}

#[test]
fn nothing_crosses_a_break() {
    let (r, _) = noisy(1e-5, None);
    let mut moved = r.clone();
    for row in 3750..7500 {
        moved.q[(row, 0)] += 0.5 * moved.time[row];
    }
    let o = PrepareOptions {
        cutoff_hz: Some(10.0),
        ..PrepareOptions::default()
    };
    let (a, b) = (prepare(&r, &o).unwrap(), prepare(&moved, &o).unwrap());
    for row in 0..3750 {
        assert_eq!(a.at_samples.qdd[(row, 0)], b.at_samples.qdd[(row, 0)]);
    }
}

#[test]
fn shared_recordings_are_prepared() {
    let Some(data) = shared("data") else {
        return;
    };
    let kr300 = read(
        &data.join("kr300/test.parquet"),
        &ReadOptions::kr300(Part::Test),
    )
    .unwrap();
    let p = prepare(&kr300, &PrepareOptions::default()).unwrap();
    assert_eq!((p.fine.segments.len(), p.report.cutoff_hz), (6, None));
    // The recorded derivatives there are those of a cubic spline: close to the quintic's.
    let recorded = kr300.qd.as_ref().unwrap();
    let apart = rms((&p.at_samples.qd - recorded).into_iter());
    assert!(apart < 1e-3 * rms(recorded.iter().copied()), "{apart}");
    println!("kr300: {:?}", p.report);
    for file in [
        "20_02_12-50sec_12harm",
        "20_02_19_14harm50sec",
        "20_02_19_15harm50sec",
    ] {
        let r = read(
            &data.join(format!("ur10e/{file}.csv")),
            &ReadOptions::for_robot(6),
        )
        .unwrap();
        let p = prepare(&r, &PrepareOptions::default()).unwrap();
        println!("{file}: {:?}", p.report);
        let hz = p.report.cutoff_hz.unwrap();
        assert!((2.0..=20.0).contains(&hz), "{file}: {hz} Hz");
    }
    let Some(cases) = shared("cases/cases") else {
        return;
    };
    for case in std::fs::read_dir(cases).unwrap() {
        let file = case.unwrap().path().join("train.parquet");
        let r = read(&file, &ReadOptions::default()).unwrap();
        let p = prepare(&r, &PrepareOptions::default()).unwrap();
        println!("{}: {:?}", file.display(), p.report);
        let hz = p.report.cutoff_hz.unwrap();
        // The easier ones are recorded at 250 Hz; of slower ones less is left.
        let least = if p.report.rate_hz > 200.0 { 5.0 } else { 1.0 };
        assert!((least..=50.0).contains(&hz), "{}: {hz} Hz", file.display());
    }
}
