//! Confidence interval of a proportion from counts.

use statrs::distribution::{Beta, ContinuousCDF};

/// Interval that holds the probability of success, but for a chance of at most `outside`, half of it on either side,
/// after `successes` in `trials` independent ones: the exact interval of C. J. Clopper and E. S. Pearson, "The use of
/// confidence or fiducial limits illustrated in the case of the binomial", Biometrika 26 (1934), by quantiles of the
/// beta distribution. Without any trial it is the whole [0, 1].
///
/// # Panics
/// If there are more successes than trials, or `outside` is not a probability.
///
/// ```
/// let [low, high] = signal::proportion::interval(67, 69, 0.05);
/// assert!((low - 0.899).abs() < 5e-4 && (high - 0.996).abs() < 5e-4);
/// ```
pub fn interval(successes: usize, trials: usize, outside: f64) -> [f64; 2] {
    assert!(successes <= trials, "{successes} successes in {trials}");
    let failures = trials - successes;
    let quantile = |a: usize, b: usize, p: f64| {
        // Both shapes are 1 or more, which Beta takes.
        Beta::new(a as f64, b as f64).map_or(f64::NAN, |d| d.inverse_cdf(p))
    };
    let low = match successes {
        0 => 0.0,
        _ => quantile(successes, failures + 1, outside / 2.0),
    };
    let high = match failures {
        0 => 1.0,
        _ => quantile(successes + 1, failures, 1.0 - outside / 2.0),
    };
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The shares of outcomes that are as far out or further, worked out term by term, are what the interval leaves outside.
    #[test]
    fn ends_are_where_the_tails_of_the_binomial_are_half_of_what_is_outside() {
        let at_least = |k: usize, n: usize, p: f64| -> f64 {
            let mut term = (1.0 - p).powi(n as i32);
            let mut below = 0.0;
            for i in 0..k {
                below += term;
                term *= (n - i) as f64 / (i + 1) as f64 * p / (1.0 - p);
            }
            1.0 - below
        };
        for (k, n, outside) in [(67, 69, 0.05), (9, 10, 0.01), (3, 40, 0.1), (1, 2, 0.3)] {
            let [low, high] = interval(k, n, outside);
            let (above, below) = (at_least(k, n, low), 1.0 - at_least(k + 1, n, high));
            assert!((above - outside / 2.0).abs() < 1e-6, "{k} in {n}: {above}");
            assert!((below - outside / 2.0).abs() < 1e-6, "{k} in {n}: {below}");
        }
    }

    #[test]
    fn intervals_are_those_of_tables() {
        let close = |[low, high]: [f64; 2], [a, b]: [f64; 2]| {
            assert!(
                (low - a).abs() < 5e-4 && (high - b).abs() < 5e-4,
                "{low} {high}"
            );
        };
        close(interval(67, 69, 0.05), [0.899, 0.996]);
        close(interval(9, 10, 0.01), [0.456, 0.9995]);
        close(interval(5, 10, 0.05), [0.187, 0.813]);
    }

    /// (1 − p)ⁿ = outside/2 where nothing succeeded.
    #[test]
    fn none_and_all_end_at_zero_and_one() {
        let end = 0.005f64.powf(0.2);
        let ([low, high], [other, one]) = (interval(0, 5, 0.01), interval(5, 5, 0.01));
        assert_eq!((low, one), (0.0, 1.0));
        assert!((high - (1.0 - end)).abs() < 1e-9 && (other - end).abs() < 1e-9);
        assert_eq!(interval(0, 0, 0.05), [0.0, 1.0]);
    }
}
