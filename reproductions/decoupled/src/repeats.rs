//! Repeated runs: mean, deviation and the paper's half-width.

use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// One quantity over n repeated runs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Repeats {
    /// Number of runs.
    pub runs: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation over the runs.
    pub std: f64,
}

impl Repeats {
    /// Of at least two values.
    pub fn of(values: &[f64]) -> Self {
        let runs = values.len();
        let mean = values.iter().sum::<f64>() / runs.max(1) as f64;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        Self {
            runs,
            mean,
            std: (squares / runs.saturating_sub(1).max(1) as f64).sqrt(),
        }
    }

    /// Half-width of the interval of confidence `level`: t_γ σ/√(n − 1), Student with n − 1 degrees of freedom (COMAU paper,
    /// Table 3: level 0.999). None for fewer than two runs.
    pub fn half_width(&self, level: f64) -> Option<f64> {
        let freedom = self.runs.checked_sub(1).filter(|&f| f > 0)? as f64;
        let student = StudentsT::new(0.0, 1.0, freedom).ok()?;
        let t = student.inverse_cdf(0.5 + 0.5 * level);
        Some(t * self.std / freedom.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comau::TABLE_3_SPREAD;

    /// Table 3's half-widths follow from its deviations with 30 runs and neither 29 nor 31: up to half a unit in the last digit
    /// of both, and of a t from a table with three decimals.
    #[test]
    fn table_3_has_thirty_runs() {
        let follow = |runs: usize| {
            TABLE_3_SPREAD.into_iter().flatten().all(|[std, half]| {
                let repeats = Repeats {
                    runs,
                    mean: 0.0,
                    std: *std,
                };
                let found = repeats.half_width(0.999).unwrap();
                let rounding = 0.5e-4 * 1.7 + 0.5e-3 * std / (runs as f64 - 1.0).sqrt();
                (found - half).abs() < rounding
            })
        };
        assert_eq!([29, 30, 31].map(follow), [false, true, false]);
    }

    #[test]
    fn by_hand() {
        let repeats = Repeats::of(&[1.0, 2.0, 3.0]);
        assert_eq!((repeats.mean, repeats.std), (2.0, 1.0));
        // t of two degrees of freedom at 97.5 %: 4.302653
        let half = repeats.half_width(0.95).unwrap();
        assert!((half - 4.302_653 / 2f64.sqrt()).abs() < 1e-5, "{half}");
        assert_eq!(Repeats::of(&[1.0]).half_width(0.95), None);
    }
}
