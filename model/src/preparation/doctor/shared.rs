//! Least squares of coefficients that all joints share, beside coefficients of each joint's own.

use super::blocks::Blocks;
use nalgebra::{DMatrix, DVector};

/// Result of a fit of coefficients that all joints share.
pub(super) struct Shared {
    /// Fitted coefficients.
    pub values: Vec<f64>,
    /// Standard deviation of each coefficient, if every joint had its floor as squared error and counted as one
    /// observation.
    pub deviations: Vec<f64>,
    /// Squared error of each joint with the fitted coefficients.
    pub left: Vec<f64>,
}

/// Fits shared coefficients to the equations of all joints, as [`reduce`] returns them. Each joint is weighted by the
/// inverse of its floor. `solve` solves normal equations.
pub(super) fn shared(
    reduced: &[(DMatrix<f64>, DVector<f64>, f64)],
    floors: &[f64],
    solve: impl Fn(&DMatrix<f64>, &DVector<f64>) -> DVector<f64>,
) -> Shared {
    let Some((first, ..)) = reduced.first() else {
        return Shared {
            values: Vec::new(),
            deviations: Vec::new(),
            left: Vec::new(),
        };
    };
    let n = first.nrows();
    let (mut a, mut b) = (DMatrix::zeros(n, n), DVector::zeros(n));
    for ((own, right, _), floor) in reduced.iter().zip(floors) {
        a += own / floor.max(f64::MIN_POSITIVE);
        b += right / floor.max(f64::MIN_POSITIVE);
    }
    let x = solve(&a, &b);
    let left = reduced
        .iter()
        .map(|(a, b, c)| c - 2.0 * x.dot(b) + x.dot(&(a * &x)));
    Shared {
        left: left.collect(),
        deviations: (0..n)
            .map(|k| {
                let unit = DVector::from_fn(n, |i, _| f64::from(u8::from(i == k)));
                solved(&a, &unit)[k].max(0.0).sqrt()
            })
            .collect(),
        values: x.iter().copied().collect(),
    }
}

/// Normal equations of one joint for the shared `columns`, after elimination of its `own` columns: matrix, right-hand
/// side, and squared target.
pub(super) fn reduce(
    blocks: &Blocks,
    columns: &[usize],
    own: &[usize],
    target: usize,
) -> (DMatrix<f64>, DVector<f64>, f64) {
    let of = blocks.product();
    let matrix = |rows: &[usize], columns: &[usize]| {
        DMatrix::from_fn(rows.len(), columns.len(), |i, j| of(rows[i], columns[j]))
    };
    let mut all = columns.to_vec();
    all.push(target);
    let cross = matrix(own, &all);
    let inner = matrix(own, own);
    let mut taken = DMatrix::zeros(own.len(), all.len());
    for c in 0..all.len() {
        taken.set_column(c, &solved(&inner, &cross.column(c).into_owned()));
    }
    let whole = matrix(&all, &all) - cross.transpose() * taken;
    let n = columns.len();
    (
        whole.view((0, 0), (n, n)).into_owned(),
        whole.view((0, n), (n, 1)).column(0).into_owned(),
        whole[(n, n)],
    )
}

/// Solution of normal equations with columns of unit norm and a small ridge. Coefficients that do not show become zero.
pub(super) fn solved(a: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    /// Ridge on columns of unit norm.
    const RIDGE: f64 = 1e-7;
    let size: Vec<f64> = a
        .diagonal()
        .iter()
        .map(|d| d.max(0.0).sqrt().max(1e-150))
        .collect();
    let n = b.len();
    let scaled = DMatrix::from_fn(n, n, |i, j| {
        a[(i, j)] / (size[i] * size[j]) + if i == j { RIDGE } else { 0.0 }
    });
    let right = DVector::from_fn(n, |i, _| b[i] / size[i]);
    let x = scaled
        .lu()
        .solve(&right)
        .unwrap_or_else(|| DVector::zeros(n));
    DVector::from_fn(n, |i, _| x[i] / size[i])
}

/// Solution of normal equations without negative coefficients, as masses have none (Lawson and Hanson, "Solving least
/// squares problems", 1974, chapter 23).
pub(super) fn positive(a: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    let n = b.len();
    let size = |k: usize| a[(k, k)].max(0.0).sqrt().max(1e-150);
    let mut x = DVector::zeros(n);
    let mut inside: Vec<usize> = Vec::new();
    // Every round lessens the error, so that no set of columns comes twice.
    for _ in 0..3 * n {
        let slope = b - a * &x;
        let outside = (0..n).filter(|k| !inside.contains(k));
        let steepest = outside
            .map(|k| (k, slope[k] / size(k)))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((next, _)) = steepest.filter(|(k, s)| *s > 1e-9 * b[*k].abs() / size(*k)) else {
            break;
        };
        inside.push(next);
        loop {
            let part = a.select_rows(&inside).select_columns(&inside);
            let own = solved(&part, &b.select_rows(&inside));
            let bound = inside.iter().zip(own.iter()).filter(|(_, v)| **v <= 0.0);
            let step = bound
                .map(|(&k, v)| x[k] / (x[k] - v).max(f64::MIN_POSITIVE))
                .fold(1.0, f64::min);
            for (&k, v) in inside.iter().zip(own.iter()) {
                x[k] += step * (v - x[k]);
            }
            if step >= 1.0 {
                break;
            }
            inside.retain(|&k| x[k] > 1e-12);
            (0..n)
                .filter(|k| !inside.contains(k))
                .for_each(|k| x[k] = 0.0);
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two links of which the sum alone shows, and one that the plain solution makes negative.
    #[test]
    fn no_mass_is_negative() {
        let columns = DMatrix::from_row_slice(4, 2, &[1.0, 0.9, 1.0, 1.1, 2.0, 2.1, 0.5, 0.4]);
        let target = DVector::from_column_slice(&[1.1, 0.9, 1.9, 0.62]);
        let (a, b) = (
            columns.transpose() * &columns,
            columns.transpose() * &target,
        );
        assert!(solved(&a, &b).min() < 0.0);
        let x = positive(&a, &b);
        assert!(x.min() >= 0.0, "{x}");
        let error = |x: &DVector<f64>| (&columns * x - &target).norm_squared();
        for other in [[0.9, 0.0], [1.1, 0.0], [0.9, 0.1], [0.0, 1.0], [0.5, 0.5]] {
            assert!(
                error(&x) <= error(&DVector::from_column_slice(&other)),
                "{x}"
            );
        }
        let inside = DVector::from_column_slice(&[0.5, 0.7]);
        let found = positive(&a, &(&a * &inside));
        assert!((found - inside).amax() < 1e-3);
    }
}
