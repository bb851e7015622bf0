//! L1: the covariance of the torque noise across joints.

use crate::least_squares::LeastSquaresError;
use faer::Mat;
use ndarray::Array2;

/// Covariance Ω of the torque noise, assumed or estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    /// Covariance σ²·1 of equal noise: ordinary least squares.
    Equal,
    /// Diagonal: one variance for each joint (eq. 12).
    PerJoint,
    /// Any covariance between the joints (eqs 16, 17).
    Full,
}

/// Noise covariance Ω from the weighted residual, samples × N (eqs 17, 27).
///
/// Rows count by their weight, and parameters are shared out over the joints. The variance that the weight
/// function cuts off from a normal distribution, of which `kept` is left, is put back: without that, outliers
/// would shrink Ω and Ω would make outliers. A joint without a row left has no noise estimate: its variance is
/// set to one, which has no effect.
pub(super) fn covariance(
    residual: &Array2<f64>,
    weights: &Array2<f64>,
    columns: usize,
    kept: f64,
    noise: Noise,
) -> Mat<f64> {
    let n = residual.ncols();
    let live: Vec<f64> = (0..n).map(|j| weights.column(j).sum()).collect();
    let weighted = residual * &weights.mapv(f64::sqrt);
    let sums = weighted.t().dot(&weighted);
    let joints: Vec<usize> = (0..n).filter(|&j| live[j] > 0.0).collect();
    let used = columns as f64 / joints.len().max(1) as f64;
    let entry = |j: usize, k: usize| {
        if live[j] == 0.0 || live[k] == 0.0 {
            return if j == k { 1.0 } else { 0.0 };
        }
        let count = ((live[j] * live[k]).sqrt() - used).max(1.0);
        sums[(j, k)] / (count * kept)
    };
    match noise {
        Noise::Full => Mat::from_fn(n, n, entry),
        Noise::PerJoint => Mat::from_fn(n, n, |j, k| if j == k { entry(j, j) } else { 0.0 }),
        Noise::Equal => {
            let sum: f64 = joints.iter().map(|&j| entry(j, j)).sum();
            faer::Scale(sum / joints.len().max(1) as f64) * Mat::<f64>::identity(n, n)
        }
    }
}

/// Ω^(−1/2), symmetric (eq. 18); none where Ω is singular.
pub(super) fn inverse_root(noise: &Mat<f64>) -> Result<Option<Mat<f64>>, LeastSquaresError> {
    let eigen = noise
        .self_adjoint_eigen(faer::Side::Lower)
        .map_err(|_| LeastSquaresError::Decomposition)?;
    let (u, values) = (eigen.U(), eigen.S());
    let n = noise.nrows();
    if (0..n).any(|i| values[i].is_nan() || values[i] <= 0.0) {
        return Ok(None);
    }
    let scaled = Mat::from_fn(n, n, |i, j| u[(i, j)] / values[j].sqrt());
    Ok(Some(scaled * u.transpose()))
}

/// Largest change of an entry, relative to the deviations of its two joints.
pub(super) fn largest_change(new: &Mat<f64>, old: &Mat<f64>) -> f64 {
    let n = new.nrows();
    let mut largest = 0.0_f64;
    for j in 0..n {
        for k in 0..n {
            let scale = (new[(j, j)] * new[(k, k)]).sqrt();
            largest = largest.max((new[(j, k)] - old[(j, k)]).abs() / scale);
        }
    }
    largest
}
