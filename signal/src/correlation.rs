//! Integrated autocorrelation time of signals.

/// Longest integrated correlation time of some signals, in samples: 1 + 2 Σ ρ_k up to the first ρ below 0.05.
pub fn correlation_time(signals: &[&[f64]]) -> f64 {
    let one = |x: &[f64]| {
        let n = x.len();
        let mean = x.iter().sum::<f64>() / n.max(1) as f64;
        let product = |k: usize| -> f64 {
            x.iter()
                .zip(&x[k..])
                .map(|(a, b)| (a - mean) * (b - mean))
                .sum()
        };
        let whole = product(0);
        let mut time = 1.0;
        if whole > 0.0 {
            for k in 1..n / 4 {
                let r = product(k) / whole;
                if r < 0.05 {
                    break;
                }
                time += 2.0 * r;
            }
        }
        time
    };
    signals.iter().map(|x| one(x)).fold(1.0, f64::max)
}
