//! Data of residual plots: autocorrelation and normal plot.

use super::{ROUNDING, products, trajectories};

/// Correlation ρ_k of samples k apart, k = 0 … `lags`, within the trajectories that begin at `starts`; zeros for a
/// residual that does not vary.
pub fn autocorrelation(residual: &[f64], starts: &[usize], lags: usize) -> Vec<f64> {
    let mean = residual.iter().sum::<f64>() / residual.len().max(1) as f64;
    let centred: Vec<f64> = residual.iter().map(|e| e - mean).collect();
    let energy: f64 = centred.iter().map(|e| e * e).sum();
    let parts = trajectories(&centred, starts);
    let sum = |lag| {
        if energy.sqrt() > ROUNDING * mean.abs() * (residual.len() as f64).sqrt() {
            products(&parts, lag) / energy
        } else {
            0.0
        }
    };
    (0..=lags).map(sum).collect()
}

/// Normal plot: up to `points` quantiles of the standard normal distribution with those of the residual, in its
/// deviations. On a straight line where normal.
pub fn normal_scores(residual: &[f64], points: usize) -> (Vec<f64>, Vec<f64>) {
    let n = residual.len();
    let mean = residual.iter().sum::<f64>() / n.max(1) as f64;
    let variance = residual.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / n.max(1) as f64;
    if variance.is_nan() || variance.sqrt() <= ROUNDING * mean.abs() {
        return (Vec::new(), Vec::new());
    }
    let mut sorted: Vec<f64> = residual
        .iter()
        .map(|e| (e - mean) / variance.sqrt())
        .collect();
    sorted.sort_by(f64::total_cmp);
    let points = points.min(n);
    (0..points)
        .map(|k| {
            let share = (k as f64 + 0.5) / points as f64;
            (normal_quantile(share), sorted[(share * n as f64) as usize])
        })
        .unzip()
}

/// Acklam's rational approximation, relative error below 1.2e-9; `p` strictly between 0 and 1.
fn normal_quantile(p: f64) -> f64 {
    const A: [f64; 6] = [
        -3.969_683_028_665_376e1,
        2.209_460_984_245_205e2,
        -2.759_285_104_469_687e2,
        1.383_577_518_672_69e2,
        -3.066_479_806_614_716e1,
        2.506_628_277_459_239,
    ];
    const B: [f64; 6] = [
        -5.447_609_879_822_406e1,
        1.615_858_368_580_409e2,
        -1.556_989_798_598_866e2,
        6.680_131_188_771_972e1,
        -1.328_068_155_288_572e1,
        1.0,
    ];
    const C: [f64; 6] = [
        -7.784_894_002_430_293e-3,
        -3.223_964_580_411_365e-1,
        -2.400_758_277_161_838,
        -2.549_732_539_343_734,
        4.374_664_141_464_968,
        2.938_163_982_698_783,
    ];
    const D: [f64; 5] = [
        7.784_695_709_041_462e-3,
        3.224_671_290_700_398e-1,
        2.445_134_137_142_996,
        3.754_408_661_907_416,
        1.0,
    ];
    let horner = |list: &[f64], x: f64| list.iter().fold(0.0, |sum, c| sum * x + c);
    if p > 0.5 {
        -normal_quantile(1.0 - p)
    } else if p < 0.02425 {
        let q = (-2.0 * p.ln()).sqrt();
        horner(&C, q) / horner(&D, q)
    } else {
        let q = p - 0.5;
        q * horner(&A, q * q) / horner(&B, q * q)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    #[test]
    fn plots_of_normal_noise() {
        // Quantiles of the standard normal distribution, textbook values.
        for (p, z) in [(0.5, 0.0), (0.975, 1.959_963_985), (0.001, -3.090_232_306)] {
            assert!((normal_quantile(p) - z).abs() < 1e-8, "{p}");
        }
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let noise: Vec<f64> = (0..5000)
            .map(|_| 3.0 + 2.0 * rng.sample::<f64, _>(StandardNormal))
            .collect();
        let (scores, values) = normal_scores(&noise, 100);
        let inner = std::iter::zip(&scores, &values).filter(|(s, _)| s.abs() < 2.0);
        assert_eq!(scores.len(), 100);
        for (s, v) in inner {
            assert!((s - v).abs() < 0.15, "{s} {v}");
        }
        let rho = autocorrelation(&noise, &[0, 2000], 10);
        assert!((rho[0] - 1.0).abs() < 1e-12 && rho[1..].iter().all(|r| r.abs() < 0.06));
        assert_eq!(autocorrelation(&[1.0; 5], &[], 2), [0.0; 3]);
        assert!(normal_scores(&[1.0; 5], 3).0.is_empty());
    }
}
