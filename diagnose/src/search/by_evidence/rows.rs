//! Whitened sums of products of one joint's columns under several sizes of its unknown torque.

use super::noise::{Shape, Whitener};
use crate::algebra::cholesky::Cholesky;
use crate::algebra::gram::JointGram;
use ndarray::{Array1, Array2, ArrayView1, Axis, concatenate};
use std::ops::Range;

/// Variances of the unknown torque over that of the white noise that are tried; the first is none at all.
pub(super) const SIZES: [f64; 6] = [0.0, 0.1, 1.0, 10.0, 100.0, 1000.0];

/// Sums of products of a joint's whitened rows under one size of its unknown torque.
pub(super) struct Level {
    /// XᵀC⁻¹X of the active columns.
    pub xx: Array2<f64>,
    /// XᵀC⁻¹y.
    pub xy: Array1<f64>,
    /// yᵀC⁻¹y.
    pub yy: f64,
    /// Logarithm of the determinant of the noise's covariance.
    pub log_determinant: f64,
}

/// Sums of products of one joint under each of [`SIZES`].
pub(super) struct JointRows {
    /// Sums of products by size of the unknown torque.
    pub levels: Vec<Level>,
    /// Number of rows with weight.
    pub rows: f64,
}

impl JointRows {
    /// Sums of products of the `columns` and the gap `y` under a noise of `shape`. `features` of the unknown torque,
    /// shape (features, rows).
    pub(super) fn new<'x>(
        columns: impl ExactSizeIterator<Item = ArrayView1<'x, f64>>,
        features: &'x Array2<f64>,
        y: ArrayView1<f64>,
        weight: ArrayView1<f64>,
        runs: &[Range<usize>],
        shape: Shape,
    ) -> Self {
        let whitener = Whitener::new(shape, weight, runs);
        let count = columns.len();
        let white: Vec<Array1<f64>> = columns
            .chain(features.rows())
            .map(|x| whitener.whiten(x))
            .collect();
        let ones = Array1::ones(y.len());
        let all = JointGram::of_rows(
            white.iter().map(|x| x.view()),
            std::slice::from_ref(&(0..y.len())),
            whitener.whiten(y).view(),
            ones.view(),
        );
        let log_determinant = whitener.log_determinant;
        let levels = SIZES
            .iter()
            .map(|&size| level(&all, count, size, log_determinant))
            .collect();
        Self {
            levels,
            rows: whitener.rows as f64,
        }
    }
}

/// Sums of products of the first `count` columns with the others integrated out under a variance `size` (Woodbury's identity).
fn level(all: &JointGram, count: usize, size: f64, log_determinant: f64) -> Level {
    let (own, features) = all.xx.view().split_at(Axis(0), count);
    let (xx, cross) = own.split_at(Axis(1), count);
    let (xy, feature_y) = all.xy.view().split_at(Axis(0), count);
    let plain = Level {
        xx: xx.to_owned(),
        xy: xy.to_owned(),
        yy: all.yy,
        log_determinant,
    };
    if size == 0.0 {
        return plain;
    }
    let mut inner = features.split_at(Axis(1), count).1.to_owned();
    inner.diag_mut().mapv_inplace(|d| d + 1.0 / size);
    let factor = Cholesky::new(&inner);
    let cross = concatenate![Axis(0), cross, feature_y.insert_axis(Axis(0))];
    let taken = factor.solve_rows(&cross).dot(&cross.t());
    let (rows, last) = taken.view().split_at(Axis(0), count);
    let (last_xy, last_yy) = last.row(0).split_at(Axis(0), count);
    Level {
        xx: plain.xx - rows.split_at(Axis(1), count).0,
        xy: plain.xy - last_xy,
        yy: plain.yy - last_yy[0],
        log_determinant: log_determinant
            + factor.log_determinant()
            + inner.nrows() as f64 * size.ln(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Products under an unknown torque are those with the inverse of its covariance, written out.
    #[test]
    fn the_unknown_torque_is_integrated_out() {
        let wave = |w: f64| Array1::from_shape_fn(7, |i| (w * i as f64).cos());
        let (x, y) = (wave(0.4), wave(1.1));
        let features = ndarray::stack![Axis(0), wave(0.9), wave(2.3)];
        let white = Shape {
            time: 4.0,
            ratio: 0.0,
        };
        let weight = Array1::ones(7);
        let columns = [x.view()].into_iter();
        let rows = JointRows::new(
            columns,
            &features,
            y.view(),
            weight.view(),
            std::slice::from_ref(&(0..7)),
            white,
        );
        for (level, size) in rows.levels.iter().zip(SIZES) {
            let covariance = Array2::eye(7) + size * features.t().dot(&features);
            let exact = Cholesky::new(&covariance);
            assert!((level.xx[[0, 0]] - x.dot(&exact.solve(x.view()))).abs() < 1e-9);
            assert!((level.xy[0] - x.dot(&exact.solve(y.view()))).abs() < 1e-9);
            assert!((level.yy - y.dot(&exact.solve(y.view()))).abs() < 1e-9);
            assert!((level.log_determinant - exact.log_determinant()).abs() < 1e-9);
        }
    }
}
