//! A torque that was low-passed before it was stored, recognised from its spectrum.
//!
//! The torque of a moving arm falls like a power of frequency until the noise of its sensor, or the steps of
//! its current, holds it up. A zero-phase filter leaves neither: beyond its edge the spectrum drops out of that
//! line to an empty band. Where that is seen, the filter is the one whose gain, over a power law, draws the
//! spectrum best.

use crate::{Recording, TorqueFilter};
use signal::quantile::median;
use signal::{resample, spectrum};
use std::ops::Range;

/// Least number of samples of a trajectory for a spectrum.
const SHORTEST: usize = 128;
/// Length of a stretch whose spectrum is taken, s, and the samples that it has at least.
const STRETCH: (f64, usize) = (8.0, 256);
/// Bins per octave in which the spectrum is averaged.
const BINS_PER_OCTAVE: f64 = 12.0;
/// Upper part of the band that has to be empty: its level, dB below the spectrum's top.
const EMPTY: (f64, f64) = (0.8, -70.0);
/// Level below the spectrum's top, dB, under which the spectrum is leakage of the window.
const DEEPEST: f64 = -90.0;
/// Attenuation over which the spectrum has to follow the filter, dB, and largest deviation from it, dB (root mean square).
const FOLLOWED: (f64, f64) = (30.0, 3.0);
/// Factor on the best candidate's deviation from the spectrum up to which other candidates are considered.
const NEXT_BEST: f64 = 1.5;
/// Orders of one pass. Ripple in dB: the smallest ones are Butterworth filters but in name.
const ORDERS: Range<usize> = 3..9;
const RIPPLES: [f64; 5] = [1e-4, 1e-2, 0.1, 0.2, 1.0];
/// Step of the cut-offs tried, as a ratio.
const STEP: f64 = 1.02;
/// Exponents that a torque's power can fall with below the edge.
const EXPONENT: Range<f64> = 0.0..6.0;

/// One point of the averaged spectrum: frequency in Hz, level in dB below the top.
type Point = (f64, f64);

/// Filters that the torque of these recordings may have been through, the likeliest first and one per order and
/// ripple; none where their stop band is not empty, or no torque is recorded.
pub fn candidates(recordings: &[Recording]) -> Vec<TorqueFilter> {
    let Some((points, rate_hz)) = averaged(recordings) else {
        return Vec::new();
    };
    let (part, level) = EMPTY;
    let top: Vec<f64> = points
        .iter()
        .filter(|(f, _)| *f > part * 0.5 * rate_hz)
        .map(|p| p.1)
        .collect();
    if median(top).is_none_or(|found| found > level) {
        return Vec::new();
    }
    let end = points
        .iter()
        .position(|p| p.1 < DEEPEST)
        .unwrap_or(points.len());
    let points = &points[..end];
    let mut found: Vec<(f64, TorqueFilter)> = ORDERS
        .flat_map(|order| RIPPLES.map(|ripple| (order, ripple)))
        .filter_map(|(order, ripple_db)| best(points, order, ripple_db, rate_hz))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let most = found
        .first()
        .map_or(0.0, |(strays, _)| (NEXT_BEST * strays).min(FOLLOWED.1));
    found
        .into_iter()
        .filter(|(strays, _)| *strays <= most)
        .map(|(_, filter)| filter)
        .collect()
}

/// Cut-off with which a kind of filter fits the spectrum best, and the deviation from it, dB (root mean square).
fn best(
    points: &[Point],
    order: usize,
    ripple_db: f64,
    rate_hz: f64,
) -> Option<(f64, TorqueFilter)> {
    let lowest = points.first()?.0;
    let steps = ((0.5 * rate_hz / lowest).ln() / STEP.ln()) as i32;
    (0..steps)
        .filter_map(|k| {
            let filter = TorqueFilter {
                order,
                ripple_db,
                cutoff_hz: lowest * STEP.powi(k),
                recognised: true,
            };
            Some((strays(points, &filter)?, filter))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Deviation of the spectrum from a power law through `filter`, dB (root mean square), from two octaves below
/// the filter's half-power frequency on. None where the spectrum does not reach far enough into the stop band,
/// or where the power law is not one that a torque has.
fn strays(points: &[Point], filter: &TorqueFilter) -> Option<f64> {
    let from = 0.25 * filter.half_power_hz();
    let rows: Vec<(f64, f64, f64)> = points
        .iter()
        .filter(|(f, _)| *f > from)
        .map(|&(f, level)| (-10.0 * f.log10(), level, filter.attenuation_db(f)))
        .collect();
    let below = rows
        .iter()
        .filter(|r| -0.1 * r.0 < filter.half_power_hz().log10())
        .count();
    let seen = rows.last()?.2;
    if rows.len() < 10 || below < 5 || seen < FOLLOWED.0 || points[0].0 > from {
        return None;
    }
    let n = rows.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64, f64)) -> f64| rows.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(&|r| r.0), mean(&|r| r.1 + r.2));
    let exponent = mean(&|r| (r.0 - x) * (r.1 + r.2 - y))
        / mean(&|r| (r.0 - x).powi(2)).max(f64::MIN_POSITIVE);
    let left = mean(&|r| (r.1 + r.2 - y - exponent * (r.0 - x)).powi(2)).sqrt();
    EXPONENT.contains(&exponent).then_some(left)
}

/// Spectrum of the torque in bins of equal width in octaves, median over joints of dB below each one's top,
/// and the rate in Hz.
fn averaged(recordings: &[Recording]) -> Option<(Vec<Point>, f64)> {
    // Recordings of another rate than the longest one cannot be averaged with it.
    let longest = recordings.iter().max_by_key(|r| r.len())?;
    let step = longest.median_step();
    let rate_hz = 1.0 / step;
    let alike = recordings
        .iter()
        .filter(|r| (r.median_step() / step - 1.0).abs() < 0.01);
    let stretches: Vec<(&Recording, Range<usize>)> = alike
        .flat_map(|r| r.segments().into_iter().map(move |s| (r, s)))
        .filter(|(_, s)| s.len() >= SHORTEST)
        .collect();
    let shortest = stretches.iter().map(|(_, s)| s.len()).min()?;
    let length = shortest.min(STRETCH.1.max((STRETCH.0 * rate_hz) as usize));
    let frequency = |k: usize| k as f64 * rate_hz / length as f64;
    let mut levels: Vec<Vec<f64>> = Vec::new();
    for joint in 0..longest.dof() {
        let mut sum = vec![0.0; length / 2 + 1];
        for (recording, rows) in &stretches {
            let tau = recording.tau.as_ref()?;
            let values: Vec<f64> = rows.clone().map(|r| tau[(r, joint)]).collect();
            let time = &recording.time[rows.clone()];
            let grid = resample::uniform_grid(time[0], time[time.len() - 1], step);
            let even = resample::cubic(time, &values, &grid).ok()?;
            let density = spectrum::deep(&even, rate_hz, length).density;
            sum.iter_mut().zip(density).for_each(|(s, d)| *s += d);
        }
        let top = sum[1..].iter().copied().fold(0.0, f64::max);
        if top > 0.0 {
            levels.push(
                sum.iter()
                    .map(|d| 10.0 * (d / top).max(1e-300).log10())
                    .collect(),
            );
        }
    }
    let mut points: Vec<(i64, f64, f64, f64)> = Vec::new();
    for k in 2..length / 2 {
        let level = median(levels.iter().map(|l| l[k]).collect())?;
        let f = frequency(k);
        let bin = (f.log2() * BINS_PER_OCTAVE).floor() as i64;
        match points.last_mut() {
            Some((last, count, sum, level_sum)) if *last == bin => {
                *count += 1.0;
                *sum += f;
                *level_sum += level;
            }
            _ => points.push((bin, 1.0, f, level)),
        }
    }
    let points = points
        .into_iter()
        .map(|(_, count, f, level)| (f / count, level / count))
        .collect();
    Some((points, rate_hz))
}
