//! How well a motion tells parameters, before anything is recorded.

use crate::least_squares::Triangle;

/// Standard deviations of the parameters that least squares would have, by the information RᵀR of rows that are divided by
/// their noise; `times`: how often each row is recorded. Infinite for a parameter without information.
pub fn deviations(triangle: &Triangle, times: f64) -> Vec<f64> {
    /// Rest of a column over its norm below which it is rounding.
    const LOST: f64 = 1e-12;
    let r = triangle.r();
    let p = r.ncols();
    // Rows of R⁻¹, by back substitution; a lost pivot has no inverse.
    let norm = |j: usize| (0..=j).map(|i| r[(i, j)].powi(2)).sum::<f64>().sqrt();
    let lost: Vec<bool> = (0..p)
        .map(|j| r[(j, j)].abs() <= LOST * norm(j).max(f64::MIN_POSITIVE))
        .collect();
    let mut variance = vec![0.0; p];
    for k in 0..p {
        if lost[k] {
            // What the column is a mixture of is not told either.
            variance[k] = f64::INFINITY;
            for (i, v) in variance.iter_mut().enumerate().take(k) {
                if r[(i, k)].abs() > LOST * norm(k) {
                    *v = f64::INFINITY;
                }
            }
            continue;
        }
        let mut x = vec![0.0; k + 1];
        for i in (0..=k).rev() {
            let rest: f64 = (i + 1..=k).map(|m| r[(i, m)] * x[m]).sum();
            let right = if i == k { 1.0 } else { 0.0 };
            x[i] = if lost[i] {
                0.0
            } else {
                (right - rest) / r[(i, i)]
            };
        }
        for (v, x) in variance.iter_mut().zip(&x) {
            *v += x * x;
        }
    }
    variance.into_iter().map(|v| (v / times).sqrt()).collect()
}
