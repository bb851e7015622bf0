//! Information of a motion on the parameters, before anything is recorded.

use crate::least_squares::Triangle;

/// Standard deviations of the parameters that least squares would have, by the information RᵀR of rows that are divided
/// by their noise. `times` is the number of times that each row is recorded. Infinite for a parameter without
/// information.
pub fn deviations(triangle: &Triangle, times: f64) -> Vec<f64> {
    /// Ratio of a column's norm after orthogonalisation to its norm before, below which the column counts as
    /// dependent (rounding).
    const LOST: f64 = 1e-12;
    /// Share of such a dependent column in another column, below which it counts as rounding.
    const MIXED: f64 = 1e-9;
    let r = triangle.r();
    let p = r.ncols();
    let norms: Vec<f64> = (0..p)
        .map(|j| (0..=j).map(|i| r[(i, j)].powi(2)).sum::<f64>().sqrt())
        .collect();
    let lost: Vec<bool> = (0..p)
        .map(|j| r[(j, j)].abs() <= LOST * norms[j].max(f64::MIN_POSITIVE))
        .collect();
    // R[..n, ..n] x = right by back substitution; a lost column takes no part.
    let solved = |right: Vec<f64>| {
        let mut x = right;
        for i in (0..x.len()).rev() {
            let rest: f64 = (i + 1..x.len()).map(|m| r[(i, m)] * x[m]).sum();
            x[i] = if lost[i] {
                0.0
            } else {
                (x[i] - rest) / r[(i, i)]
            };
        }
        x
    };
    let mut variance = vec![0.0; p];
    for k in 0..p {
        if lost[k] {
            // What the column is a mixture of is not told either.
            variance[k] = f64::INFINITY;
            let mixture = solved((0..k).map(|i| r[(i, k)]).collect());
            for (i, part) in mixture.into_iter().enumerate() {
                if part.abs() * norms[i] > MIXED * norms[k] {
                    variance[i] = f64::INFINITY;
                }
            }
            continue;
        }
        let mut unit = vec![0.0; k + 1];
        unit[k] = 1.0;
        for (v, x) in variance.iter_mut().zip(solved(unit)) {
            *v += x * x;
        }
    }
    variance.into_iter().map(|v| (v / times).sqrt()).collect()
}
