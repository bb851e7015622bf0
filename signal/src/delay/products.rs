//! Least squares from products of columns with the target last.

use crate::cholesky;
use ndarray::{ArrayView1, ArrayView2};

/// Adds the products of one row to the upper triangle.
pub(super) fn add_row(sums: &mut [f64], row: &[f64], y: f64) {
    let p = row.len();
    for i in 0..p {
        let line = &mut sums[i * (p + 1) + i..(i + 1) * (p + 1)];
        for (sum, v) in line.iter_mut().zip(row[i..].iter().chain([&y])) {
            *sum += row[i] * v;
        }
    }
    sums[p * (p + 1) + p] += y * y;
}

/// Sums of products of all rows of `p` columns each, and of the target.
pub(super) fn sums(rows: &[f64], p: usize, target: &[f64]) -> Vec<f64> {
    let x = ArrayView2::from_shape((target.len(), p), rows).expect("p values of each row");
    let y = ArrayView1::from(target);
    let (products, last) = (x.t().dot(&x), x.t().dot(&y));
    let mut out = Vec::with_capacity((p + 1) * (p + 1));
    for (row, &last) in products.rows().into_iter().zip(&last) {
        out.extend(row.iter().copied().chain([last]));
    }
    out.extend(last.iter().copied().chain([y.dot(&y)]));
    out
}

/// Ridge of columns of unit norm: determines coefficients that the rows do not.
const RIDGE: f64 = 1e-9;

/// Cholesky factor (lower, by rows) of the scaled normal equations of the first `p` columns, with the scales.
fn factor(sums: &[f64], p: usize) -> (Vec<f64>, Vec<f64>) {
    let width = (sums.len() as f64).sqrt() as usize;
    let at = |i: usize, j: usize| sums[i.min(j) * width + i.max(j)];
    let scale: Vec<f64> = (0..p)
        .map(|i| if at(i, i) > 0.0 { at(i, i).sqrt() } else { 1.0 })
        .collect();
    let mut l = vec![0.0; p * p];
    for i in 0..p {
        for j in 0..=i {
            let ridge = if i == j { RIDGE } else { 0.0 };
            l[i * p + j] = at(i, j) / (scale[i] * scale[j]) + ridge;
        }
    }
    cholesky::factor_above(&mut l, p, RIDGE);
    (l, scale)
}

/// Least squares of the last column by the others: coefficients and residual sum of squares.
pub(super) fn fitted(sums: &[f64], p: usize) -> (Vec<f64>, f64) {
    let (l, scale) = factor(sums, p);
    let width = p + 1;
    let mut x: Vec<f64> = (0..p).map(|i| sums[i * width + p] / scale[i]).collect();
    cholesky::solve(&l, &mut x);
    let x: Vec<f64> = x.iter().zip(&scale).map(|(x, s)| x / s).collect();
    let mut left = sums[p * width + p];
    for i in 0..p {
        left -= 2.0 * x[i] * sums[i * width + p];
        for j in 0..p {
            left += x[i] * x[j] * sums[i.min(j) * width + i.max(j)];
        }
    }
    (x, left.max(0.0))
}

/// Sum of squares of the last of the first `p` columns that the others leave.
pub(super) fn own_part(sums: &[f64], p: usize) -> f64 {
    let (l, scale) = factor(sums, p);
    (l[p * p - 1] * scale[p - 1]).powi(2)
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
