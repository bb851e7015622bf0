//! Derivatives of sampled signals.

/// Second-order differences on any grid; one-sided at the ends, as `numpy.gradient` with
/// `edge_order = 1`. A signal of fewer than two samples has derivative zero.
///
/// `time` and `values` have one entry per sample.
pub fn differences(time: &[f64], values: &[f64]) -> Vec<f64> {
    let n = time.len().min(values.len());
    if n < 2 {
        return vec![0.0; n];
    }
    let slope = |i: usize| (values[i + 1] - values[i]) / (time[i + 1] - time[i]);
    let mut out = Vec::with_capacity(n);
    out.push(slope(0));
    for i in 1..n - 1 {
        let (before, after) = (time[i] - time[i - 1], time[i + 1] - time[i]);
        out.push((after * slope(i - 1) + before * slope(i)) / (before + after));
    }
    out.push(slope(n - 2));
    out
}
