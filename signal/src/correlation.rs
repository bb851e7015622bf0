//! Shift between two signals.

/// Where the correlation of two signals peaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// Samples by which the second signal is later than the first; between samples by a parabola.
    pub samples: f64,
    /// Correlation coefficient at the peak sample, −1 to 1.
    pub correlation: f64,
}

/// Lag of `y` behind `x` within ± `max_lag` samples, by the largest correlation coefficient over
/// the samples that both have at each shift.
///
/// `None` when there are fewer than `2 max_lag + 3` samples, or when a signal is constant.
pub fn lag(x: &[f64], y: &[f64], max_lag: usize) -> Option<Lag> {
    let n = x.len().min(y.len());
    if n < 2 * max_lag + 3 {
        return None;
    }
    let at = |shift: isize| {
        let s = shift.unsigned_abs();
        let (a, b) = if shift >= 0 {
            (&x[..n - s], &y[s..n])
        } else {
            (&x[s..n], &y[..n - s])
        };
        correlation(a, b)
    };
    let shifts: Vec<f64> = (-(max_lag as isize)..=max_lag as isize)
        .map(at)
        .collect::<Option<_>>()?;
    let best = (0..shifts.len()).max_by(|&a, &b| shifts[a].total_cmp(&shifts[b]))?;
    let mut samples = best as f64 - max_lag as f64;
    if best > 0 && best + 1 < shifts.len() {
        let (left, mid, right) = (shifts[best - 1], shifts[best], shifts[best + 1]);
        let bend = left - 2.0 * mid + right;
        if bend < 0.0 {
            samples += 0.5 * (left - right) / bend;
        }
    }
    Some(Lag {
        samples,
        correlation: shifts[best],
    })
}

/// Pearson's coefficient; `None` for a constant signal.
pub fn correlation(x: &[f64], y: &[f64]) -> Option<f64> {
    let n = x.len().min(y.len()) as f64;
    let mean = |v: &[f64]| v.iter().sum::<f64>() / n;
    let (mx, my) = (mean(x), mean(y));
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for (a, b) in x.iter().zip(y) {
        xx += (a - mx) * (a - mx);
        yy += (b - my) * (b - my);
        xy += (a - mx) * (b - my);
    }
    (xx > 0.0 && yy > 0.0).then(|| xy / (xx * yy).sqrt())
}
