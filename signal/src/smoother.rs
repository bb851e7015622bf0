//! Zero-phase low-pass without end effects.

use crate::sos::DesignError;

/// Order of the penalised difference; see [`low_pass`].
pub const ORDER: usize = 3;

/// Zero-phase low-pass of a uniformly sampled signal (Whittaker 1923, Eilers 2003):
///
/// y = argmin Σ (x_i − y_i)² + λ Σ (Δ³y)_i²,  λ = (2 sin(π f_c/f_s))⁻⁶.
///
/// Away from the ends its gain is 1/(1 + λ (2 sin(πf/f_s))⁶): a Butterworth filter of order 3 run
/// forwards and backwards, −6 dB at `cutoff_hz`. At the ends nothing is made up: where
/// [`crate::filter::filtfilt`] mirrors the signal, and with it the sign of its curvature, here the
/// smoothest continuation of the data decides, and parabolas pass unchanged. That keeps the
/// accelerations derived from it usable up to the first and last sample.
///
/// Signals of three samples or fewer come back as they are.
///
/// # Errors
/// A cut-off outside (0, rate/2).
pub fn low_pass(x: &[f64], cutoff_hz: f64, rate_hz: f64) -> Result<Vec<f64>, DesignError> {
    if !(cutoff_hz > 0.0 && cutoff_hz < 0.5 * rate_hz && rate_hz.is_finite()) {
        return Err(DesignError::Cutoff { cutoff_hz, rate_hz });
    }
    let n = x.len();
    if n <= ORDER {
        return Ok(x.to_vec());
    }
    let lambda = (2.0 * (std::f64::consts::PI * cutoff_hz / rate_hz).sin()).powi(-6);

    // Solve for the correction z = x − y, which is small where x is smooth, so that rounding does
    // not grow with x: (I + λDᵀD) z = λDᵀD x.
    let third: Vec<f64> = x
        .windows(4)
        .map(|w| (w[3] - w[0]) - 3.0 * (w[2] - w[1]))
        .collect();
    const STENCIL: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];
    let mut z = vec![0.0; n];
    // Columns of the upper band: diagonals[k][i] couples i and i + k.
    let mut bands = vec![[0.0; ORDER + 1]; n];
    for row in &mut bands {
        row[0] = 1.0;
    }
    for (i, d) in third.iter().enumerate() {
        for a in 0..=ORDER {
            z[i + a] += lambda * STENCIL[a] * d;
            for b in a..=ORDER {
                bands[i + a][b - a] += lambda * STENCIL[a] * STENCIL[b];
            }
        }
    }
    solve_symmetric(&mut bands, &mut z);
    Ok(x.iter().zip(z).map(|(x, z)| x - z).collect())
}

/// Solves A z = b in place by LDLᵀ for a positive definite band matrix.
fn solve_symmetric(bands: &mut [[f64; ORDER + 1]], z: &mut [f64]) {
    let n = bands.len();
    for i in 0..n {
        let row = bands[i];
        for a in 1..=ORDER.min(n - 1 - i) {
            let factor = row[a] / row[0];
            for b in a..=ORDER.min(n - 1 - i) {
                bands[i + a][b - a] -= factor * row[b];
            }
            z[i + a] -= factor * z[i];
        }
    }
    for i in (0..n).rev() {
        let row = bands[i];
        let mut sum = z[i];
        for a in 1..=ORDER.min(n - 1 - i) {
            sum -= row[a] * z[i + a];
        }
        z[i] = sum / row[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{filter, sos};
    use std::f64::consts::PI;

    #[test]
    fn inside_it_is_a_butterworth_filter_run_both_ways() {
        // Both have the gain 1/(1 + (f/f_c)⁶), up to the warping of sin against tan.
        let rate = 1000.0;
        let x: Vec<f64> = (0..4000)
            .map(|i| {
                let t = f64::from(i) / rate;
                (2.0 * PI * 3.0 * t).sin()
                    + (2.0 * PI * 10.0 * t).sin()
                    + (2.0 * PI * 25.0 * t).sin()
            })
            .collect();
        let ours = low_pass(&x, 10.0, rate).unwrap();
        let theirs = filter::filtfilt(&sos::butterworth(3, 10.0, rate).unwrap(), &x);
        for i in 1000..3000 {
            assert!(
                (ours[i] - theirs[i]).abs() < 2e-3,
                "{i}: {} {}",
                ours[i],
                theirs[i]
            );
        }
    }

    #[test]
    fn a_parabola_passes_up_to_its_ends() {
        let x: Vec<f64> = (0..300)
            .map(|i| 2.0 + f64::from(i) - 0.01 * f64::from(i * i))
            .collect();
        let y = low_pass(&x, 5.0, 250.0).unwrap();
        for (a, b) in x.iter().zip(&y) {
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    }

    #[test]
    fn a_cutoff_outside_the_band_is_refused() {
        for hz in [0.0, -1.0, 50.0, f64::NAN] {
            assert!(low_pass(&[0.0; 9], hz, 100.0).is_err());
        }
    }
}
