//! Periodic data as a Fourier series.

use crate::cholesky;
use std::f64::consts::TAU;

/// c + Σ a_k cos k ω t + b_k sin k ω t, fitted by least squares: of data whose motion is such a series (Swevers et al., IEEE Trans.
/// Robotics and Automation 13(5), 1997; COMAU paper, section 3.3) it gives derivatives without any difference of noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Harmonics {
    /// Fundamental angular frequency ω, rad/s.
    pulsation: f64,
    /// Coefficients c, then a₁, b₁, a₂, b₂ … of the series.
    coefficients: Vec<f64>,
}

/// Reason why samples do not determine a series.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum HarmonicsError {
    /// A period that is not positive, or no harmonic.
    #[error("a period of {period} s with {harmonics} harmonics is no series")]
    Series {
        /// Period that was asked for, s.
        period: f64,
        /// Number of harmonics asked for.
        harmonics: usize,
    },
    /// Too few samples or too short a stretch of the period.
    #[error("{samples} samples do not tell a series of {harmonics} harmonics")]
    Samples {
        /// Number of samples that were given.
        samples: usize,
        /// Number of harmonics asked for.
        harmonics: usize,
    },
}

impl Harmonics {
    /// The series of `period` seconds with `harmonics` harmonics nearest to `values` at `time` (s).
    ///
    /// # Errors
    /// See [`HarmonicsError`].
    ///
    /// # Panics
    /// Where `time` and `values` differ in length.
    pub fn fit(
        time: &[f64],
        values: &[f64],
        period: f64,
        harmonics: usize,
    ) -> Result<Self, HarmonicsError> {
        assert_eq!(time.len(), values.len(), "one value for each time");
        if !(period > 0.0 && period.is_finite() && harmonics > 0) {
            return Err(HarmonicsError::Series { period, harmonics });
        }
        let n = 2 * harmonics + 1;
        let short = HarmonicsError::Samples {
            samples: time.len(),
            harmonics,
        };
        if time.len() < n {
            return Err(short);
        }
        let mut series = Self {
            pulsation: TAU / period,
            coefficients: vec![0.0; n],
        };
        let (mut normal, mut row) = (vec![0.0; n * n], vec![0.0; n]);
        for (t, y) in time.iter().zip(values) {
            series.row(*t, &mut row);
            for i in 0..n {
                series.coefficients[i] += row[i] * y;
                for j in 0..=i {
                    normal[i * n + j] += row[i] * row[j];
                }
            }
        }
        // Less than a good part of a period makes the columns alike.
        let least = 1e-10 * time.len() as f64;
        let mut factor = normal;
        cholesky::factor(&mut factor, n).ok_or(short)?;
        if (0..n).any(|i| factor[i * n + i].powi(2) < least) {
            return Err(short);
        }
        cholesky::solve(&factor, &mut series.coefficients);
        Ok(series)
    }

    fn row(&self, t: f64, row: &mut [f64]) {
        row[0] = 1.0;
        for (k, pair) in row[1..].chunks_exact_mut(2).enumerate() {
            let (sin, cos) = ((k + 1) as f64 * self.pulsation * t).sin_cos();
            pair.copy_from_slice(&[cos, sin]);
        }
    }

    /// Value, first and second derivative at a time, s.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let mut out = [self.coefficients[0], 0.0, 0.0];
        for (k, pair) in self.coefficients[1..].chunks_exact(2).enumerate() {
            let w = (k + 1) as f64 * self.pulsation;
            let (sin, cos) = (w * t).sin_cos();
            let value = pair[0] * cos + pair[1] * sin;
            out[0] += value;
            out[1] += w * (pair[1] * cos - pair[0] * sin);
            out[2] -= w * w * value;
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 + 3 cos ωt − 0.5 sin 2ωt over two periods of 4 s, with its derivatives by hand.
    #[test]
    fn by_hand() {
        let w = TAU / 4.0;
        let time: Vec<f64> = (0..80).map(|k| 0.1 * f64::from(k)).collect();
        let value = |t: f64| 2.0 + 3.0 * (w * t).cos() - 0.5 * (2.0 * w * t).sin();
        let values: Vec<f64> = time.iter().map(|t| value(*t)).collect();
        let series = Harmonics::fit(&time, &values, 4.0, 3).unwrap();
        let t = 1.234;
        let [x, v, a] = series.at(t);
        assert!((x - value(t)).abs() < 1e-12);
        let speed = -3.0 * w * (w * t).sin() - w * (2.0 * w * t).cos();
        assert!((v - speed).abs() < 1e-11, "{v} {speed}");
        let rate = -3.0 * w * w * (w * t).cos() + 2.0 * w * w * (2.0 * w * t).sin();
        assert!((a - rate).abs() < 1e-11, "{a} {rate}");
    }

    #[test]
    fn what_tells_no_series() {
        assert!(Harmonics::fit(&[0.0, 1.0], &[0.0, 1.0], 1.0, 2).is_err());
        assert!(Harmonics::fit(&[0.0; 9], &[0.0; 9], 0.0, 2).is_err());
        // All samples at one time.
        assert!(Harmonics::fit(&[0.5; 9], &[0.0; 9], 4.0, 2).is_err());
    }
}
