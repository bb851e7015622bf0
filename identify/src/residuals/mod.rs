//! Residual tests as numbers: is the residual noise?
//!
//! Normality, independence in time, and no remainder against fitted torque or velocity: the assumptions of least
//! squares (Han et al., IEEE T-RO 36(5), 2020, section III-D, shown there as plots).

mod plots;

pub use plots::{autocorrelation, normal_scores};

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// Number of lags of the Ljung–Box statistic; even, so that its tail has a closed form.
const LAGS: usize = 20;
/// Number of cells of fitted torque and velocity.
const CELLS: usize = 20;

/// Deviation below which a residual is constant, relative to its mean.
const ROUNDING: f64 = 1e-12;

/// Reason why residuals could not be tested.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ResidualError {
    /// Fitted torque or velocity of another length than the residual.
    #[error("{found} values of {what} for {expected} residuals")]
    Size {
        /// Name of the quantity with the wrong length.
        what: &'static str,
        /// Length of the quantity as found.
        found: usize,
        /// Number of samples of the residual.
        expected: usize,
    },
    /// Too few samples, values that are not finite, or a residual that does not vary.
    #[error("the residual cannot be tested: {0}")]
    Unusable(&'static str),
}

/// Tests of one joint's residual. Every p-value is the probability of a statistic at least as large where the
/// assumption holds; those of [`ResidualTests::serial`] apart, they assume independent samples and are too small by
/// far where `effective_samples` is much below `samples`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ResidualTests {
    /// Number of samples of the residual.
    pub samples: usize,
    /// Mean of the residual, torque units.
    pub mean: f64,
    /// Standard deviation, torque units.
    pub std: f64,
    /// Shape of the distribution.
    pub normality: Normality,
    /// Independence of the residual in time.
    pub serial: Serial,
    /// Remainder against the fitted torque.
    pub against_fitted: Remainder,
    /// Remainder against the joint velocity.
    pub against_velocity: Remainder,
}

/// Jarque and Bera, 1980: n/6 (S² + K²/4), chi-squared with two degrees of freedom where normal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Normality {
    /// Skewness S; zero where normal.
    pub skewness: f64,
    /// Excess kurtosis K; zero where normal, positive for heavy tails.
    pub excess_kurtosis: f64,
    /// Statistic n/6 (S² + K²/4) of the test of Jarque and Bera.
    pub jarque_bera: f64,
    /// P-value of the statistic (chi-squared, two degrees of freedom).
    pub p_value: f64,
}

/// Autocorrelation within trajectories.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Serial {
    /// Autocorrelation at lag one: correlation of neighbouring samples.
    pub lag_one: f64,
    /// Ljung and Box, 1978, over 20 lags.
    pub ljung_box: f64,
    /// P-value of the statistic (chi-squared, 20 degrees of freedom).
    pub p_value: f64,
    /// Effective number of independent samples: n/(1 + 2 Σ ρ_k), the sum cut where pairs of neighbouring terms
    /// cease to be positive (Geyer, 1992). That many independent samples would give the mean with the same
    /// precision.
    pub effective_samples: f64,
}

/// Dependence of the residual's mean on another quantity, in cells of equal count.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Remainder {
    /// Linear correlation: near zero by construction where the model is least squares with that column.
    pub correlation: f64,
    /// Share of the residual's variance that the means of 20 cells explain, beyond that expected of independent
    /// noise (adjusted η²); about zero in a horizontal band.
    pub explained: f64,
    /// Wald and Wolfowitz, 1940: normal deviate of the number of runs of equal sign, the samples sorted by the other
    /// quantity; strongly negative where the residual bends.
    pub runs: f64,
}

/// Tests the residual of one joint. `breaks` are the first samples of the trajectories after the first: no lag
/// reaches across them.
///
/// # Errors
/// Lengths that do not agree, fewer than 50 samples, values that are not finite, a constant residual.
pub fn residual_tests(
    residual: &[f64],
    fitted: &[f64],
    velocity: &[f64],
    breaks: &[usize],
) -> Result<ResidualTests, ResidualError> {
    let n = residual.len();
    for (what, values) in [("fitted torque", fitted), ("velocity", velocity)] {
        if values.len() != n {
            return Err(ResidualError::Size {
                what,
                found: values.len(),
                expected: n,
            });
        }
    }
    if n < 50 {
        return Err(ResidualError::Unusable("fewer than 50 samples"));
    }
    let all = residual.iter().chain(fitted).chain(velocity);
    if all.into_iter().any(|v| !v.is_finite()) {
        return Err(ResidualError::Unusable("it holds NaN or infinite values"));
    }
    let count = n as f64;
    let mean = residual.iter().sum::<f64>() / count;
    let centred: Vec<f64> = residual.iter().map(|e| e - mean).collect();
    let moment = |k: i32| centred.iter().map(|e| e.powi(k)).sum::<f64>() / count;
    let variance = moment(2);
    // The mean's own rounding is all that a constant residual has.
    if variance.sqrt() <= ROUNDING * mean.abs() {
        return Err(ResidualError::Unusable("it does not vary"));
    }
    let skewness = moment(3) / variance.powf(1.5);
    let excess_kurtosis = moment(4) / (variance * variance) - 3.0;
    let jarque_bera = count / 6.0 * (skewness.powi(2) + excess_kurtosis.powi(2) / 4.0);
    Ok(ResidualTests {
        samples: n,
        mean,
        std: variance.sqrt(),
        normality: Normality {
            skewness,
            excess_kurtosis,
            jarque_bera,
            p_value: chi_squared_tail(jarque_bera, 2),
        },
        serial: serial(&centred, breaks),
        against_fitted: remainder(&centred, fitted),
        against_velocity: remainder(&centred, velocity),
    })
}

/// The pieces between breaks.
fn trajectories<'a>(values: &'a [f64], breaks: &[usize]) -> Vec<&'a [f64]> {
    let n = values.len();
    let mut ends: Vec<usize> = breaks.iter().copied().filter(|&b| b > 0 && b < n).collect();
    ends.push(n);
    ends.sort_unstable();
    let mut first = 0;
    ends.into_iter()
        .map(|end| {
            let part = &values[first..end];
            first = end;
            part
        })
        .collect()
}

/// Σ e_k e_{k+lag} within the pieces.
fn products(parts: &[&[f64]], lag: usize) -> f64 {
    parts
        .iter()
        .filter(|part| part.len() > lag)
        .flat_map(|part| std::iter::zip(*part, &part[lag..]))
        .map(|(a, b)| a * b)
        .sum()
}

fn serial(centred: &[f64], breaks: &[usize]) -> Serial {
    let n = centred.len();
    let parts = trajectories(centred, breaks);
    let energy: f64 = centred.iter().map(|e| e * e).sum();
    let correlation = |lag: usize| products(&parts, lag) / energy;
    let early: Vec<f64> = (1..=LAGS).map(correlation).collect();
    let count = n as f64;
    let ljung_box = early
        .iter()
        .enumerate()
        .map(|(k, r)| r * r / (count - (k + 1) as f64))
        .sum::<f64>()
        * count
        * (count + 2.0);
    // Geyer's initial positive sequence: ρ_2k + ρ_2k+1, ρ_0 = 1.
    let mut sum = 0.0;
    for k in 0..n / 2 {
        let even = if k == 0 { 1.0 } else { correlation(2 * k) };
        let pair = even + correlation(2 * k + 1);
        if pair <= 0.0 {
            break;
        }
        sum += pair;
    }
    Serial {
        lag_one: early[0],
        ljung_box,
        p_value: chi_squared_tail(ljung_box, LAGS),
        effective_samples: (count / (2.0 * sum - 1.0).max(1.0)).max(1.0),
    }
}

fn remainder(centred: &[f64], other: &[f64]) -> Remainder {
    let n = centred.len();
    let count = n as f64;
    let mean = other.iter().sum::<f64>() / count;
    let energy: f64 = centred.iter().map(|e| e * e).sum();
    let spread: f64 = other.iter().map(|v| (v - mean).powi(2)).sum();
    let product: f64 = std::iter::zip(centred, other)
        .map(|(e, v)| e * (v - mean))
        .sum();
    let correlation = if spread > 0.0 {
        product / (energy * spread).sqrt()
    } else {
        0.0
    };

    // Equal values, of a joint that stands, in an order that is not time's: what drifts would count as explained by them.
    let mut order: Vec<usize> = (0..n).collect();
    order.shuffle(&mut ChaCha8Rng::seed_from_u64(0));
    order.sort_by(|&a, &b| other[a].total_cmp(&other[b]));
    let mut between = 0.0;
    for cell in 0..CELLS {
        let members = &order[cell * n / CELLS..(cell + 1) * n / CELLS];
        let sum: f64 = members.iter().map(|&k| centred[k]).sum();
        between += sum * sum / members.len() as f64;
    }
    let share = between / energy;
    let free = (CELLS - 1) as f64;
    let explained = 1.0 - (1.0 - share) * (count - 1.0) / (count - 1.0 - free);

    let positive: Vec<bool> = order.iter().map(|&k| centred[k] > 0.0).collect();
    let up = positive.iter().filter(|p| **p).count() as f64;
    let down = count - up;
    let runs = 1.0 + positive.windows(2).filter(|w| w[0] != w[1]).count() as f64;
    let expected = 2.0 * up * down / count + 1.0;
    let variance = (expected - 1.0) * (expected - 2.0) / (count - 1.0);
    Remainder {
        correlation,
        explained,
        runs: if variance > 0.0 {
            (runs - expected) / variance.sqrt()
        } else {
            0.0
        },
    }
}

/// P(χ² > x) for an even number of degrees of freedom: e^(−x/2) Σ_{k < d/2} (x/2)^k / k!.
fn chi_squared_tail(x: f64, degrees: usize) -> f64 {
    let half = 0.5 * x;
    let (mut term, mut sum) = (1.0, 0.0);
    for k in 0..degrees / 2 {
        sum += term;
        term *= half / (k + 1) as f64;
    }
    // e^(−x/2) underflows before the sum overflows.
    let tail = (-half).exp() * sum;
    if tail.is_nan() { 0.0 } else { tail }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use rand_distr::StandardNormal;
    use serde_json::Value;

    fn vector(v: &Value) -> Vec<f64> {
        let values = v.as_array().unwrap().iter();
        values.map(|x| x.as_f64().unwrap()).collect()
    }

    #[test]
    fn scipy_agrees() {
        let f: Value =
            serde_json::from_str(include_str!("../../tests/fixtures/residuals.json")).unwrap();
        let residual = vector(&f["residual"]);
        let found = residual_tests(
            &residual,
            &vector(&f["fitted"]),
            &vector(&f["velocity"]),
            &[],
        )
        .unwrap();
        let close = |found: f64, name: &str| {
            let expected = f[name].as_f64().unwrap();
            let error = (found - expected).abs();
            assert!(
                error <= 1e-9 * expected.abs().max(1e-3),
                "{name}: {found}, {expected}"
            );
        };
        close(found.normality.jarque_bera, "jarque_bera");
        close(found.normality.p_value, "jarque_bera_p");
        close(found.normality.skewness, "skewness");
        close(found.serial.lag_one, "lag_one");
        close(found.serial.ljung_box, "ljung_box");
        close(found.serial.p_value, "ljung_box_p");
        close(found.against_velocity.correlation, "velocity_correlation");
        close(found.against_fitted.runs, "fitted_runs");
    }

    #[test]
    fn white_noise_passes_and_a_bend_does_not() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut draw =
            |n: usize| -> Vec<f64> { (0..n).map(|_| rng.sample(StandardNormal)).collect() };
        let (noise, fitted, velocity) = (draw(20_000), draw(20_000), draw(20_000));
        let clean = residual_tests(&noise, &fitted, &velocity, &[]).unwrap();
        assert!(clean.normality.p_value > 1e-3 && clean.serial.p_value > 1e-3);
        assert!(clean.serial.effective_samples > 15_000.0);
        for part in [clean.against_fitted, clean.against_velocity] {
            assert!(part.explained.abs() < 3e-3 && part.runs.abs() < 4.0);
        }
        // A square of velocity that no linear term sees: variance 2·0.25 against 1.
        let bent: Vec<f64> = std::iter::zip(&noise, &velocity)
            .map(|(e, v)| e + 0.5 * v * v)
            .collect();
        let bent = residual_tests(&bent, &fitted, &velocity, &[]).unwrap();
        assert!(bent.against_velocity.explained > 0.2 && bent.against_velocity.runs < -10.0);
        assert!(bent.against_fitted.explained < 3e-3);
    }

    #[test]
    fn autoregressive_noise_has_its_known_effective_samples() {
        // ρ_k = 0.9^k: n (1 − 0.9)/(1 + 0.9).
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let mut e = 0.0;
        let noise: Vec<f64> = (0..50_000)
            .map(|_| {
                let fresh: f64 = rng.sample(StandardNormal);
                e = 0.9 * e + fresh;
                e
            })
            .collect();
        let flat = vec![0.0; noise.len()];
        let found = residual_tests(&noise, &flat, &flat, &[10_000, 30_000]).unwrap();
        assert!((found.serial.lag_one - 0.9).abs() < 0.01);
        let expected = 50_000.0 * 0.1 / 1.9;
        assert!((found.serial.effective_samples / expected - 1.0).abs() < 0.2);
        assert_eq!(found.serial.p_value, 0.0);
    }

    #[test]
    fn drift_of_a_joint_that_stands_is_not_explained_by_its_velocity() {
        let ramp: Vec<f64> = (0..5000).map(f64::from).collect();
        let stands = vec![0.0; ramp.len()];
        let found = residual_tests(&ramp, &ramp, &stands, &[]).unwrap();
        assert!(found.against_velocity.explained.abs() < 0.02);
        assert!(found.against_velocity.runs.abs() < 4.0);
        assert!(found.against_fitted.explained > 0.99);
    }

    #[test]
    fn bad_input_is_refused() {
        assert!(residual_tests(&[0.1; 60], &[0.0; 60], &[0.0; 60], &[]).is_err());
        assert!(residual_tests(&[1.0; 60], &[0.0; 59], &[0.0; 60], &[]).is_err());
        assert!(residual_tests(&[1.0; 60], &[0.0; 60], &[0.0; 60], &[]).is_err());
        assert!(residual_tests(&[1.0; 10], &[0.0; 10], &[0.0; 10], &[]).is_err());
    }
}
