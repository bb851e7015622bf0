//! Choice of the low-pass from the data.
//!
//! Encoder counts and sensor noise are white in position, with one-sided density N₀; motion falls
//! off steeply with frequency. A low-pass of gain H(f) = 1/(1 + (f/f_c)⁶) leaves an error in
//! acceleration of
//!
//! J(f_c) = Σ_f H² N(f) + (1 − H)² S(f)
//!
//! with the density P of the recorded accelerations, N = |D(f)|⁴ N₀ their noise and S = P − N where
//! P stands clear of N, otherwise 0: noise that passes plus motion that is lost. All joints share one cut-off: the minimum of
//! Σ_j J_j(f_c)/Var(q̈_j).
//!
//! Spectra are taken of second differences, whose small range keeps the window's leakage below the
//! noise floor, with the exact gain D(f) = 2 sin(πfΔ)/Δ of a difference over one step.

use serde::Serialize;
use signal::quantile::median;
use signal::spectrum::{Spectrum, welch};

/// Band in which the noise floor is read, as parts of half the rate: above all motion.
const FLOOR_BAND: [f64; 2] = [0.4, 0.8];

/// Band in which the noise floor is read for jittered stamps, as fractions of half the sampling rate: the
/// interpolation to a uniform grid attenuates noise at higher frequencies.
const FLOOR_BAND_JITTERED: [f64; 2] = [0.15, 0.35];

/// Relative deviation of the time steps from which stamps count as jittered.
const JITTERED: f64 = 0.02;

/// Band in which the noise floor of a recording is read, from the relative jitter of its stamps.
pub(crate) fn floor_band(jitter: f64) -> [f64; 2] {
    if jitter > JITTERED {
        FLOOR_BAND_JITTERED
    } else {
        FLOOR_BAND
    }
}

/// Length of Welch's segments in s.
const SEGMENT_S: f64 = 4.0;

/// Lowest and highest cut-off, as parts of the rate; the lower bound is at least 1 Hz.
const LIMITS: [f64; 2] = [0.01, 0.25];

/// Factor on the noise's density from which a bin of the spectrum shows motion; less is chance.
const CLEAR: f64 = 3.0;

/// Number of cut-offs that are tried, evenly spaced in their logarithm: neighbours differ by about 4 %.
const CANDIDATES: usize = 80;

/// Noise of one joint's position and the cut-off that fits it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NoiseFloor {
    /// One-sided density of position noise in rad²/Hz (m²/Hz).
    pub position_density: f64,
    /// One-sided density of the noise of this joint's recorded velocity, (rad/s)²/Hz ((m/s)²/Hz). None where that velocity
    /// was not fused with the position; no cut-off depends on it.
    pub velocity_density: Option<f64>,
    /// Cut-off with the smallest expected error of acceleration in Hz; `None` when the joint
    /// shows no motion above its noise.
    pub best_cutoff_hz: Option<f64>,
}

/// |D(f)|² of a difference over one step, in rad²/s².
pub(crate) fn difference_gain(frequency: f64, step: f64) -> f64 {
    (2.0 * (std::f64::consts::PI * frequency * step).sin() / step).powi(2)
}

/// Mean density of the k-th differences (divided by stepᵏ) over trajectories, on one frequency
/// axis; `None` when all are too short.
pub(crate) fn difference_spectrum(
    trajectories: &[Vec<f64>],
    step: f64,
    order: usize,
) -> Option<Spectrum> {
    let longest = trajectories
        .iter()
        .map(Vec::len)
        .max()?
        .checked_sub(order)?;
    let segment = ((SEGMENT_S / step) as usize).min(longest);
    if segment < 16 {
        return None;
    }
    let mut mean: Option<(Spectrum, f64)> = None;
    for x in trajectories.iter().filter(|x| x.len() >= segment + order) {
        let mut d = x.clone();
        for _ in 0..order {
            d = d.windows(2).map(|w| (w[1] - w[0]) / step).collect();
        }
        let weight = d.len() as f64;
        let one = welch(&d, 1.0 / step, segment);
        match &mut mean {
            None => {
                let density = one.density.iter().map(|p| p * weight).collect();
                mean = Some((Spectrum { density, ..one }, weight));
            }
            Some((sum, total)) => {
                sum.density
                    .iter_mut()
                    .zip(&one.density)
                    .for_each(|(s, p)| *s += p * weight);
                *total += weight;
            }
        }
    }
    mean.map(|(mut sum, total)| {
        sum.density.iter_mut().for_each(|p| *p /= total);
        sum
    })
}

/// Median of `density / gain(f)` over a band given as parts of half the rate.
pub(crate) fn floor_of(spectrum: &Spectrum, band: [f64; 2], gain: impl Fn(f64) -> f64) -> f64 {
    let nyquist = spectrum.frequency.last().copied().unwrap_or(0.0);
    let band = band[0] * nyquist..=band[1] * nyquist;
    let levels: Vec<f64> = spectrum
        .frequency
        .iter()
        .zip(&spectrum.density)
        .filter(|(f, _)| band.contains(f))
        .map(|(&f, p)| p / gain(f))
        .collect();
    median(levels).unwrap_or(0.0)
}

/// J(f_c)/Var(q̈) of one joint at the [`candidates`]; empty for a joint without motion.
pub(crate) type Cost = Vec<f64>;

/// Cut-offs that are tried, in Hz.
fn candidates(rate_hz: f64) -> impl Iterator<Item = f64> {
    let high = LIMITS[1] * rate_hz;
    let low = (LIMITS[0] * rate_hz).max(1.0).min(high);
    let ratio = high / low;
    (0..CANDIDATES).map(move |k| low * ratio.powf(k as f64 / (CANDIDATES - 1) as f64))
}

fn cost(acceleration: &Spectrum, noise: impl Fn(f64) -> f64, rate_hz: f64) -> Cost {
    let bins: Vec<[f64; 3]> = acceleration
        .frequency
        .iter()
        .zip(&acceleration.density)
        .map(|(&f, &p)| {
            let n = noise(f);
            [f, n, if p > CLEAR * n { p - n } else { 0.0 }]
        })
        .collect();
    let motion: f64 = bins.iter().map(|[.., s]| s).sum();
    if motion <= 0.0 {
        return Vec::new();
    }
    candidates(rate_hz)
        .map(|cutoff| {
            let error = bins.iter().map(|[f, n, s]| {
                let gain = 1.0 / (1.0 + (f / cutoff).powi(6));
                gain * gain * n + (1.0 - gain) * (1.0 - gain) * s
            });
            error.sum::<f64>() / motion
        })
        .collect()
}

/// The candidate at which a cost is least.
fn least(cost: &[f64], rate_hz: f64) -> Option<f64> {
    let pairs = candidates(rate_hz).zip(cost);
    pairs.min_by(|a, b| a.1.total_cmp(b.1)).map(|(hz, _)| hz)
}

/// Noise floor of a joint's position on the uniform grids, and the cost J of each candidate cut-off.
pub(crate) fn position_floor(
    trajectories: &[Vec<f64>],
    step: f64,
    band: [f64; 2],
) -> (NoiseFloor, Cost) {
    let spectrum = difference_spectrum(trajectories, step, 2);
    let gain = |f: f64| difference_gain(f, step).powi(2);
    let floor = spectrum.as_ref().map_or(0.0, |s| floor_of(s, band, gain));
    let rate_hz = 1.0 / step;
    let cost = spectrum.map_or_else(Vec::new, |s| cost(&s, |f| floor * gain(f), rate_hz));
    let noise = NoiseFloor {
        position_density: floor,
        velocity_density: None,
        best_cutoff_hz: least(&cost, rate_hz),
    };
    (noise, cost)
}

/// Cut-off that all joints share, Hz. Without motion in any joint, which the check of the recording reports, it
/// is the lowest candidate.
pub(crate) fn common(joints: &[&Cost], rate_hz: f64) -> f64 {
    let mut total = vec![0.0; CANDIDATES];
    for cost in joints {
        total.iter_mut().zip(cost.iter()).for_each(|(t, c)| *t += c);
    }
    least(&total, rate_hz).unwrap_or(LIMITS[1] * rate_hz)
}
