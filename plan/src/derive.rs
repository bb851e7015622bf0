//! Derivatives of a plan's values, which are exact but for the digits that they were written with.

use signal::spline::{Spline, SplineError};
use std::ops::Range;

/// Rate, Hz, below which rounding is left alone: waypoints are written by hand in whole tenths and mean them, and second
/// differences over such steps do not magnify the last digit.
const DENSE_HZ: f64 = 40.0;

/// Decimals that values may have been rounded to.
const DECIMALS: i32 = 12;

/// Part of a unit of the last decimal up to which a value counts as a multiple of it.
const MULTIPLE: f64 = 1e-3;

/// Units of rounding from which a displacement shows how it grows with time.
const SHOWS: f64 = 32.0;

/// First and second derivatives of a column at its stamps `time`, s, by segment.
///
/// # Errors
/// Segments of fewer than 6 samples.
pub fn derivatives(
    time: &[f64],
    segments: &[Range<usize>],
    values: &[f64],
) -> Result<[Vec<f64>; 2], SplineError> {
    let (mut first, mut second) = (Vec::new(), Vec::new());
    for segment in segments {
        let (time, values) = (&time[segment.clone()], &values[segment.clone()]);
        let span = time[time.len() - 1] - time[0];
        let dense = (time.len() - 1) as f64 > DENSE_HZ * span;
        let rounding = if dense { rounding(values) } else { 0.0 };
        let back: Vec<f64> = values.iter().rev().copied().collect();
        let [start, end] = [values, &back].map(|v| still(v, rounding));
        // An end that is held still though it moves costs many short pieces: then it is smoother when it is free.
        let mut best: Option<(f64, [Vec<f64>; 3])> = None;
        for ends in [[start, end], [0, end], [start, 0], [0, 0]] {
            let found = Spline::coarsest(time, values, ends, rounding)?.sample(time);
            let rough = roughness(&found[2]);
            if best.as_ref().is_none_or(|(least, _)| rough < *least) {
                best = Some((rough, found));
            }
        }
        if let Some((_, [_, mut speed, mut turn])) = best {
            first.append(&mut speed);
            second.append(&mut turn);
        }
    }
    Ok([first, second])
}

/// Sum of the squared changes of a column from sample to sample.
fn roughness(values: &[f64]) -> f64 {
    values.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum()
}

/// Unit of the last decimal that a column was written with, in its present unit: decimals of radians or metres, or of degrees;
/// zero where the values have more than [`DECIMALS`]. An offset of the zero leaves differences, and so the unit, as they are.
fn rounding(values: &[f64]) -> f64 {
    let whole = |unit: f64| {
        values.iter().all(|v| {
            let units = (v - values[0]) / unit;
            (units - units.round()).abs() < MULTIPLE
        })
    };
    let of = |scale: f64| {
        let mut units = (0..=DECIMALS).map(|d| scale * 10_f64.powi(-d));
        units.find(|unit| whole(*unit)).unwrap_or(0.0)
    };
    of(1.0).max(of(1.0_f64.to_radians()))
}

/// Number of derivatives, two at most, that vanish at the first of the values, which are evenly spaced.
///
/// The displacement grows with the first power of time where a motion comes with a speed, with the second where it starts
/// from rest with an acceleration, with a higher one where it starts softly. The power is read where the displacement first
/// exceeds what rounding can feign. A column that never does stands still.
fn still(values: &[f64], rounding: f64) -> usize {
    let displacement = |k: usize| (values[k] - values[0]).abs();
    let shows = |k: &usize| displacement(*k) > SHOWS * rounding;
    match (1..values.len()).find(shows) {
        None => 2,
        Some(k) if 2 * k >= values.len() => 0,
        Some(k) => match (displacement(2 * k) / displacement(k)).log2() {
            power if power > 2.5 => 2,
            power if power > 1.5 => 1,
            _ => 0,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest error of the second derivative over a motion of `seconds` by `rate` Hz, printed with 6 decimals, as a part of
    /// its largest value. `motion` gives position and second derivative over a part of the whole.
    fn worst(motion: impl Fn(f64) -> [f64; 2], seconds: f64, rate: f64) -> f64 {
        let n = (seconds * rate).round() as usize;
        let time: Vec<f64> = (0..=n).map(|k| k as f64 / rate).collect();
        let part = |k: usize| motion(k as f64 / n as f64);
        let printed = |k: usize| format!("{:.6}", 0.3 + 0.5 * part(k)[0]);
        let values: Vec<f64> = (0..=n).map(|k| printed(k).parse().unwrap()).collect();
        let [_, found] = derivatives(&time, std::slice::from_ref(&(0..n + 1)), &values).unwrap();
        let truth = |k: usize| 0.5 * part(k)[1] / seconds.powi(2);
        let largest = (0..=n).map(|k| truth(k).abs()).fold(0.0, f64::max);
        let error = (0..=n).map(|k| (found[k] - truth(k)).abs());
        error.fold(0.0, f64::max) / largest
    }

    #[test]
    fn accelerations_of_printed_positions_over_the_whole_plan() {
        let minimum_jerk = |u: f64| {
            [
                u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u),
                60.0 * u - 180.0 * u * u + 120.0 * u.powi(3),
            ]
        };
        let w = 2.0 * std::f64::consts::PI;
        let cycloid = |u: f64| [u - (w * u).sin() / w, w * (w * u).sin()];
        // Begins and ends at rest, with an acceleration.
        let there = |u: f64| {
            [
                0.5 - 0.5 * (0.5 * w * u).cos(),
                0.125 * w * w * (0.5 * w * u).cos(),
            ]
        };
        for seconds in [0.6, 1.0, 2.0, 5.0] {
            for rate in [100.0, 1000.0] {
                for (name, error) in [
                    ("minimum jerk", worst(minimum_jerk, seconds, rate)),
                    ("cycloid", worst(cycloid, seconds, rate)),
                    ("half a cosine", worst(there, seconds, rate)),
                ] {
                    assert!(error < 0.03, "{name}, {seconds} s at {rate} Hz: {error}");
                }
            }
        }
    }

    #[test]
    fn a_plan_that_begins_in_motion() {
        // Some begin near an extremum, at a speed that hardly shows.
        let phases = (0..16).map(|k| 0.4 * f64::from(k));
        let near = [0.001, 0.002, 0.004, 0.008, 0.016].map(|d| std::f64::consts::FRAC_PI_2 + d);
        for phase in phases.chain(near) {
            let wave = |u: f64| {
                let x = 7.0 * u + phase;
                [x.sin(), -49.0 * x.sin()]
            };
            for rate in [100.0, 1000.0] {
                let error = worst(wave, 2.0, rate);
                assert!(error < 0.03, "phase {phase}, {rate} Hz: {error}");
            }
        }
    }

    #[test]
    fn waypoints_far_apart_are_met() {
        let time: Vec<f64> = (0..8).map(|k| 0.5 * f64::from(k)).collect();
        let values = [0.0, 0.1, 0.3, 0.4, 0.3, 0.3, 0.2, 0.0];
        let [speed, turn] = derivatives(&time, std::slice::from_ref(&(0..8)), &values).unwrap();
        let spline = Spline::quintic(&time, &values).unwrap();
        for (k, t) in time.iter().enumerate() {
            assert_eq!([speed[k], turn[k]], spline.at(*t)[1..]);
        }
        assert!(derivatives(&time[..5], std::slice::from_ref(&(0..5)), &values[..5]).is_err());
    }

    #[test]
    fn decimals_of_radians_and_degrees() {
        let to = |decimals: i32, unit: f64| -> Vec<f64> {
            let step = 10_f64.powi(decimals);
            let values = (0..50).map(|k| ((0.1 * f64::from(k)).sin() * step).round() / step);
            values.map(|v| v * unit + 0.7).collect()
        };
        let close = |a: f64, b: f64| (a - b).abs() < 1e-6 * b;
        assert!(close(rounding(&to(6, 1.0)), 1e-6));
        assert!(close(rounding(&to(4, -1.0)), 1e-4));
        assert!(close(
            rounding(&to(3, 1.0_f64.to_radians())),
            1e-3_f64.to_radians()
        ));
        assert_eq!(rounding(&to(15, 1.0)), 0.0);
        assert_eq!(still(&[0.0; 9], 1e-6), 2);
    }
}
