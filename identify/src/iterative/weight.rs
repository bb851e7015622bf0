//! Weight functions of iteratively reweighted least squares.

/// Weight of a row by its normalised residual r (residual over its standard deviation).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Weight {
    /// Weight 1 for every row: no row is an outlier.
    Equal,
    /// Weight 1 up to `threshold`, 0 beyond: the "T class hard redescender" of Han et al. (2020), threshold 3.
    Hard {
        /// Normalised residual from which the weight is zero, in standard deviations.
        threshold: f64,
    },
    /// Weight 1 up to `threshold`, threshold/|r| beyond (Huber, 1964); 1.345 is 95 % efficient on normal noise.
    Huber {
        /// Normalised residual from which the weight falls, in standard deviations.
        threshold: f64,
    },
    /// Weight (1 − (r/threshold)²)² up to `threshold`, 0 beyond (Beaton and Tukey, 1974); 4.685 is 95 % efficient.
    Tukey {
        /// Normalised residual from which the weight is zero, in standard deviations.
        threshold: f64,
    },
}

impl Weight {
    /// The weight of normalised residual `r`, 0 to 1.
    pub fn of(self, r: f64) -> f64 {
        let r = r.abs();
        match self {
            Self::Equal => 1.0,
            Self::Hard { threshold } => f64::from(u8::from(r <= threshold)),
            Self::Huber { threshold } => {
                if r <= threshold {
                    1.0
                } else {
                    threshold / r
                }
            }
            Self::Tukey { threshold } => {
                if r <= threshold {
                    (1.0 - (r / threshold).powi(2)).powi(2)
                } else {
                    0.0
                }
            }
        }
    }

    /// E[w r²]/E[w] of standard normal r: the factor by which weighting lowers the variance of clean noise.
    pub(super) fn variance_of_normal(self) -> f64 {
        // Midpoint rule on ±10 standard deviations; the jump of `Hard` costs 1e-6.
        const CELLS: usize = 20_000;
        let step = 10.0 / CELLS as f64;
        let (mut second, mut total) = (0.0, 0.0);
        for k in 0..CELLS {
            let r = (k as f64 + 0.5) * step;
            let w = self.of(r) * (-0.5 * r * r).exp();
            second += w * r * r;
            total += w;
        }
        second / total
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_by_hand() {
        assert_eq!(Weight::Hard { threshold: 3.0 }.of(-2.9), 1.0);
        assert_eq!(Weight::Hard { threshold: 3.0 }.of(-3.1), 0.0);
        assert_eq!(Weight::Huber { threshold: 1.5 }.of(-3.0), 0.5);
        assert_eq!(Weight::Tukey { threshold: 2.0 }.of(1.0), 0.5625);
        assert_eq!(Weight::Tukey { threshold: 2.0 }.of(2.5), 0.0);
    }

    #[test]
    fn truncated_normal_has_its_textbook_variance() {
        // 1 − 2·3·φ(3)/(2Φ(3) − 1), φ(3) = 0.00443184841, Φ(3) = 0.99865010197.
        let expected = 1.0 - 6.0 * 0.004_431_848_411_9 / 0.997_300_203_94;
        let found = Weight::Hard { threshold: 3.0 }.variance_of_normal();
        assert!((found - expected).abs() < 2e-6);
        assert!((Weight::Equal.variance_of_normal() - 1.0).abs() < 1e-9);
    }
}
