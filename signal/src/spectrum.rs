//! Power spectral densities.

use rustfft::{FftPlanner, num_complex::Complex};

/// One-sided power spectral density.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Frequencies in Hz, from 0.
    pub frequency: Vec<f64>,
    /// Density at each frequency, units²/Hz.
    pub density: Vec<f64>,
}

/// Density of one segment, mean removed, weighted with `window`; adds to `sum`.
fn accumulate(
    x: &[f64],
    window: &[f64],
    rate_hz: f64,
    fft: &dyn rustfft::Fft<f64>,
    sum: &mut [f64],
) {
    let n = x.len();
    let mean = x.iter().sum::<f64>() / n as f64;
    let mut buffer: Vec<Complex<f64>> = x
        .iter()
        .zip(window)
        .map(|(v, w)| Complex::new((v - mean) * w, 0.0))
        .collect();
    fft.process(&mut buffer);
    let scale = 1.0 / (rate_hz * window.iter().map(|w| w * w).sum::<f64>());
    for (k, s) in sum.iter_mut().enumerate() {
        let alone = k == 0 || 2 * k == n;
        *s += buffer[k].norm_sqr() * scale * if alone { 1.0 } else { 2.0 };
    }
}

fn frequencies(n: usize, rate_hz: f64) -> Vec<f64> {
    (0..=n / 2).map(|k| k as f64 * rate_hz / n as f64).collect()
}

/// Periodogram of the signal less its mean (`scipy.signal.periodogram`).
pub fn periodogram(x: &[f64], rate_hz: f64) -> Spectrum {
    let n = x.len();
    if n == 0 {
        return Spectrum {
            frequency: Vec::new(),
            density: Vec::new(),
        };
    }
    let fft = FftPlanner::new().plan_fft_forward(n);
    let mut density = vec![0.0; n / 2 + 1];
    accumulate(x, &vec![1.0; n], rate_hz, fft.as_ref(), &mut density);
    Spectrum {
        frequency: frequencies(n, rate_hz),
        density,
    }
}

/// Welch's average over segments of `segment` samples with a Hann window, overlapping by half,
/// each less its mean (`scipy.signal.welch`). A longer segment than the signal is cut to it.
pub fn welch(x: &[f64], rate_hz: f64, segment: usize) -> Spectrum {
    averaged(x, rate_hz, segment, |angle| (0.5 * angle).sin().powi(2))
}

/// Spectrum like [`welch`], with the four-term Blackman–Harris window: a component 92 dB below a strong line is
/// visible from four bins beside it on.
pub fn deep(x: &[f64], rate_hz: f64, segment: usize) -> Spectrum {
    averaged(x, rate_hz, segment, |angle| {
        0.35875 - 0.48829 * angle.cos() + 0.14128 * (2.0 * angle).cos()
            - 0.01168 * (3.0 * angle).cos()
    })
}

/// Average over segments that overlap by half, weighted with a window over the angle from 0 to 2π.
fn averaged(x: &[f64], rate_hz: f64, segment: usize, window: impl Fn(f64) -> f64) -> Spectrum {
    let n = segment.min(x.len());
    if n < 2 {
        return periodogram(x, rate_hz);
    }
    let window: Vec<f64> = (0..n)
        .map(|i| window(std::f64::consts::TAU * i as f64 / n as f64))
        .collect();
    let fft = FftPlanner::new().plan_fft_forward(n);
    let mut density = vec![0.0; n / 2 + 1];
    let hop = n - n / 2;
    let starts: Vec<usize> = (0..=x.len() - n).step_by(hop).collect();
    for &start in &starts {
        accumulate(
            &x[start..start + n],
            &window,
            rate_hz,
            fft.as_ref(),
            &mut density,
        );
    }
    density.iter_mut().for_each(|d| *d /= starts.len() as f64);
    Spectrum {
        frequency: frequencies(n, rate_hz),
        density,
    }
}

/// Signal with the spectrum of `x` and the phases, rad, that `phase` gives: one for each frequency between zero and the
/// highest one, in order. The mean keeps its value.
pub fn rephased(x: &[f64], mut phase: impl FnMut() -> f64) -> Vec<f64> {
    let n = x.len();
    let mut planner = FftPlanner::new();
    let mut buffer: Vec<Complex<f64>> = x.iter().map(|v| Complex::new(*v, 0.0)).collect();
    planner.plan_fft_forward(n).process(&mut buffer);
    for k in 1..n.div_ceil(2) {
        let turned = Complex::from_polar(buffer[k].norm(), phase());
        (buffer[k], buffer[n - k]) = (turned, turned.conj());
    }
    planner.plan_fft_inverse(n).process(&mut buffer);
    buffer.into_iter().map(|c| c.re / n as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_phases_keep_the_spectrum() {
        for n in [1, 2, 7, 64] {
            let x: Vec<f64> = (0..n).map(|i| f64::from(i * i % 11) - 2.0).collect();
            let mut phase = 0.0;
            let y = rephased(&x, || {
                phase += 2.0;
                phase
            });
            let of = |x: &[f64]| periodogram(x, 1.0).density;
            assert!(of(&x).iter().zip(of(&y)).all(|(a, b)| (a - b).abs() < 1e-9));
            assert!((x.iter().sum::<f64>() - y.iter().sum::<f64>()).abs() < 1e-9);
            assert!(n < 7 || x.iter().zip(&y).any(|(a, b)| (a - b).abs() > 0.1));
        }
    }

    #[test]
    fn a_deep_spectrum_shows_what_lies_far_below_a_line() {
        // Between two bins, where leakage is worst.
        let x: Vec<f64> = (0..2048)
            .map(|i| (std::f64::consts::TAU * 20.5 / 512.0 * f64::from(i)).sin())
            .collect();
        let beside = |s: Spectrum| {
            let top = s.density.iter().copied().fold(0.0, f64::max);
            let beyond = s.density[30..].iter().copied().fold(0.0, f64::max);
            (10.0 * (beyond / top).log10(), s.density.iter().sum::<f64>())
        };
        let ((hann, all), (harris, same)) =
            (beside(welch(&x, 512.0, 512)), beside(deep(&x, 512.0, 512)));
        assert!(hann > -80.0 && harris < -90.0, "{hann} {harris}");
        // The variance, less that of each segment's mean: half a cycle more than whole ones leaves about 1/(20.5 π).
        assert!(
            (all - 0.5).abs() < 1e-3 && (same - 0.5).abs() < 1e-3,
            "{all} {same}"
        );
    }
}
