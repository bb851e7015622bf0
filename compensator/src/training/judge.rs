//! Judgement whether a trained unit is used.

use super::samples::Samples;
use crate::config::UnitConfig;

/// Errors on the validation trajectories with and without a prediction.
pub(super) struct Judged {
    /// Weighted RMS error with the prediction, N·m.
    pub with: f64,
    /// Weighted RMS error without the prediction, N·m: that of the target alone.
    pub without: f64,
    /// Whether the prediction lowers the error by enough, and by more than chance, to be used.
    pub helps: bool,
}

/// Judges a prediction `predicted` for every row of the samples, on the `validation` trajectories.
pub(super) fn judge_prediction(
    samples: &Samples,
    validation: &[usize],
    config: &UnitConfig,
    predicted: &[f32],
) -> Judged {
    let (mut with, mut without, mut total) = (0.0, 0.0, 0.0);
    let mut gains = Vec::with_capacity(validation.len());
    for &trajectory in validation {
        let mut gain = 0.0;
        for row in samples.trajectories()[trajectory].clone() {
            let w = f64::from(samples.weight(row));
            let y = f64::from(samples.target(row));
            let (left, all) = (w * (y - f64::from(predicted[row])).powi(2), w * y * y);
            with += left;
            without += all;
            total += w;
            gain += all - left;
        }
        gains.push(gain);
    }
    let [with, without] = [with, without].map(|sum| (sum / total).sqrt());
    let enough = with <= without * (1.0 - f64::from(config.least_gain));
    Judged {
        with,
        without,
        helps: enough && beyond_chance(&gains, f64::from(config.sure)),
    }
}

/// Whether the mean gain over trajectories is `sure` standard errors above zero. Always true for one
/// trajectory, which gives no standard error.
fn beyond_chance(gains: &[f64], sure: f64) -> bool {
    let n = gains.len() as f64;
    if gains.len() < 2 {
        return true;
    }
    let mean = gains.iter().sum::<f64>() / n;
    let squares = gains.iter().map(|g| (g - mean).powi(2)).sum::<f64>();
    mean >= sure * (squares / (n - 1.0) / n).sqrt()
}

#[cfg(test)]
mod tests {
    use super::beyond_chance;

    /// Four gains of mean 1 and standard deviation 1: two standard errors of 1/2 are reached, three are not.
    #[test]
    fn a_gain_is_held_against_its_standard_error() {
        let half = 0.75_f64.sqrt();
        let gains = [1.0 - half, 1.0 + half, 1.0 - half, 1.0 + half];
        assert!(beyond_chance(&gains, 1.99) && !beyond_chance(&gains, 2.01));
        assert!(!beyond_chance(&[-1.0, -1.1, -0.9], 2.0));
        assert!(beyond_chance(&[-1.0], 2.0), "nothing to judge chance by");
        assert!(beyond_chance(&[1.0; 3], 2.0));
    }
}
