//! Fusion of a recorded velocity with the position.
//!
//! Position noise of density N_q is (2πf)² N_q in velocity; a recorded velocity has its own noise
//! of density N_v. Below f_x = √(N_v/N_q)/2π the derivative of position is the better one, above it
//! the recorded velocity. Where f_x is low enough to matter, both are joined by complementary
//! zero-phase filters into one position signal
//!
//! q* = L(q) + s − L(s), s = ∫ q̇_recorded dt, L = low-pass at f_x,
//!
//! which then takes the way of any position. A velocity that is late, scaled or otherwise not the
//! derivative of the position is not used.

use super::cutoff::{self, NoiseFloor};
use signal::{smoother, sos};

/// Largest part of the velocity's deviation that may disagree with dq/dt in the band of the motion.
const DISAGREEMENT: f64 = 0.02;

/// Fuses position and recorded velocity on uniform grids: `(positions, density of the velocity's
/// noise)`. `None` when velocity does not help or
/// does not fit.
pub(crate) fn fuse(
    position: &[Vec<f64>],
    velocity: &[Vec<f64>],
    step: f64,
    alone: &NoiseFloor,
    floor_band: [f64; 2],
) -> Option<(Vec<Vec<f64>>, f64)> {
    let rate_hz = 1.0 / step;
    let band = alone.best_cutoff_hz?;
    let spectrum = cutoff::difference_spectrum(velocity, step, 1)?;
    let gain = |f: f64| cutoff::difference_gain(f, step);
    let velocity_noise = cutoff::floor_of(&spectrum, floor_band, gain);
    let position_noise = alone.position_density;
    if position_noise <= 0.0 {
        return None;
    }
    let crossing = (velocity_noise / position_noise).sqrt() / (2.0 * std::f64::consts::PI);
    // Above the band nothing is kept anyway.
    if crossing >= band {
        return None;
    }
    // Far below it the filters would outlast a trajectory.
    let crossing = crossing.max(0.5);
    let band_sections = sos::butterworth(4, band.min(0.4 * rate_hz), rate_hz).ok()?;

    let (mut apart, mut whole) = (0.0, 0.0);
    let mut values = Vec::with_capacity(position.len());
    for (q, v) in position.iter().zip(velocity) {
        let mut s = 0.0;
        let difference: Vec<f64> = (0..q.len())
            .map(|i| {
                if i > 0 {
                    s += 0.5 * (v[i] + v[i - 1]) * step;
                }
                q[i] - s
            })
            .collect();
        // q* = s + L(q − s).
        let low = smoother::low_pass(&difference, crossing, rate_hz).ok()?;
        values.push(
            (0..q.len())
                .map(|i| q[i] - difference[i] + low[i])
                .collect::<Vec<_>>(),
        );

        let slope: Vec<f64> = (1..q.len() - 1)
            .map(|i| (q[i + 1] - q[i - 1]) / (2.0 * step) - v[i])
            .collect();
        let slope = signal::filter::filtfilt(&band_sections, &slope);
        let mean = v.iter().sum::<f64>() / v.len() as f64;
        apart += slope.iter().map(|d| d * d).sum::<f64>();
        whole += v.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
    }
    if apart > DISAGREEMENT * DISAGREEMENT * whole {
        return None;
    }
    Some((values, velocity_noise))
}
