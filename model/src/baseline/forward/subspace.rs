//! A and C by subspace projection (N4SID with canonical-variate weights).
//!
//! With block rows of i past and i future samples, U_f, Y_f, and W_p = [U_p; Y_p], the future outputs are
//! Y_f = Γ X + H U_f + noise. Projecting out U_f and onto W_p leaves Γ X: in the QR decomposition of
//! [U_f; W_p; Y_f]ᵀ it is the block R₂₃ᵀ (Van Overschee & De Moor, "Subspace Identification for Linear
//! Systems", 1996, sections 4.3–4.4). Its singular vectors, weighted by the inverse square root of the
//! covariance of Y_f without U_f (their section 4.3.3), span Γ = [C; CA; CA²; …], from which C is read off
//! and A follows by shift invariance.

use super::settings::ForwardSettings;
use crate::baseline::BaselineError;
use ::identify::least_squares::Accumulator;
use faer::linalg::solvers::SolveLstsq;
use faer::{Mat, MatRef, Scale};
use ndarray::Array2;
use std::ops::Range;

/// Singular value, relative to the largest, below which the value counts as rounding.
const NEGLIGIBLE: f64 = 1e-9;

/// Spectral radius from which A counts as unstable.
const STABLE_RADIUS: f64 = 1.0;

/// Dynamics of a state space: A (n × n, stable) and C (outputs × n).
pub(super) struct Dynamics {
    pub(super) a: Mat<f64>,
    pub(super) c: Mat<f64>,
}

/// Identifies A and C from normalised inputs and outputs (samples, channels). The number of states is lower
/// than asked for where the data show fewer.
pub(super) fn identify(
    u: &Array2<f64>,
    y: &Array2<f64>,
    trajectories: &[Range<usize>],
    settings: &ForwardSettings,
) -> Result<Dynamics, BaselineError> {
    let (horizon, outputs) = (settings.horizon, y.ncols());
    let future_inputs = horizon * u.ncols();
    let past = future_inputs + horizon * outputs;
    let future_outputs = horizon * outputs;
    let r = hankel_factor(u, y, trajectories, horizon)?;

    let projected = r
        .as_ref()
        .submatrix(future_inputs, future_inputs + past, past, future_outputs);
    // All of Y_f that U_f does not explain: R₂₃ and R₃₃.
    let unexplained = r.as_ref().submatrix(
        future_inputs,
        future_inputs + past,
        past + future_outputs,
        future_outputs,
    );
    let observability = weighted_range(projected, unexplained, settings.order)?;
    let c = observability.as_ref().subrows(0, outputs).to_owned();
    let a = shift_solution(&observability, outputs)?;
    Ok(Dynamics { a, c })
}

/// R of the QR decomposition of the block Hankel matrix; a row is [u_future, u_past, y_past, y_future]
/// at one instant, with all its samples in one trajectory.
fn hankel_factor(
    u: &Array2<f64>,
    y: &Array2<f64>,
    trajectories: &[Range<usize>],
    horizon: usize,
) -> Result<Mat<f64>, BaselineError> {
    let columns = 2 * horizon * (u.ncols() + y.ncols());
    let mut rows = Accumulator::new(columns);
    let mut row = Vec::with_capacity(columns);
    let mut instants = 0;
    for trajectory in trajectories.iter().filter(|t| t.len() >= 2 * horizon) {
        for now in trajectory.start + horizon..=trajectory.end - horizon {
            row.clear();
            row.extend((now..now + horizon).flat_map(|k| u.row(k).to_vec()));
            row.extend((now - horizon..now).flat_map(|k| u.row(k).to_vec()));
            row.extend((now - horizon..now + horizon).flat_map(|k| y.row(k).to_vec()));
            rows.push(&row, 0.0, 1.0)?;
            instants += 1;
        }
    }
    if instants < columns {
        return Err(BaselineError::TooShort {
            found: instants,
            needed: columns,
        });
    }
    Ok(rows.finish()?.r().to_owned())
}

/// Γ: the `order` strongest directions of the projection in the metric of the covariance.
///
/// With W the square root of unexplainedᵀ·unexplained = V Σ² Vᵀ, Γ = W·U₁·S₁^½ where U S … is the
/// singular value decomposition of W⁻¹·projectedᵀ. Both are formed in the basis V.
fn weighted_range(
    projected: MatRef<'_, f64>,
    unexplained: MatRef<'_, f64>,
    order: usize,
) -> Result<Mat<f64>, BaselineError> {
    let failed = |_| BaselineError::Decomposition;
    let covariance = unexplained.thin_svd().map_err(failed)?;
    let sigma: Vec<f64> = covariance.S().column_vector().iter().copied().collect();
    let kept = significant(&sigma);
    let basis = covariance.V().subcols(0, kept);
    let mut whitened = basis.transpose() * projected.transpose();
    for (i, s) in sigma[..kept].iter().enumerate() {
        let row = Scale(1.0 / s) * whitened.as_ref().row(i);
        whitened.as_mut().row_mut(i).copy_from(row);
    }
    let svd = whitened.thin_svd().map_err(failed)?;
    let strength: Vec<f64> = svd.S().column_vector().iter().copied().collect();
    let order = order.min(significant(&strength));
    let directions = svd.U().subcols(0, order);
    let scaled = Mat::from_fn(kept, order, |i, j| {
        sigma[i] * directions[(i, j)] * strength[j].sqrt()
    });
    Ok(basis * scaled)
}

/// Number of leading values, in descending order, that are not rounding.
fn significant(values: &[f64]) -> usize {
    let largest = values.first().copied().unwrap_or(0.0);
    values
        .iter()
        .take_while(|v| **v > NEGLIGIBLE * largest)
        .count()
}

/// A from Γ without its last block row times A = Γ without its first.
///
/// Where that A is unstable, the equation is closed with a zero block behind Γ (J. M. Maciejowski,
/// "Guaranteed stability with subspace methods", 1995): in an orthonormal basis of Γ's range, A is then
/// a part of a matrix of norm 1 and cannot be unstable.
fn shift_solution(observability: &Mat<f64>, outputs: usize) -> Result<Mat<f64>, BaselineError> {
    let (rows, n) = (observability.nrows(), observability.ncols());
    let upper = observability.as_ref().subrows(0, rows - outputs);
    let lower = observability.as_ref().subrows(outputs, rows - outputs);
    let a = upper.qr().solve_lstsq(&lower);
    if spectral_radius(&a)? < STABLE_RADIUS {
        return Ok(a);
    }
    let shifted = Mat::from_fn(rows, n, |i, j| {
        if i + outputs < rows {
            observability[(i + outputs, j)]
        } else {
            0.0
        }
    });
    Ok(observability.qr().solve_lstsq(&shifted))
}

fn spectral_radius(a: &Mat<f64>) -> Result<f64, BaselineError> {
    let eigenvalues = a.eigenvalues().map_err(|_| BaselineError::Decomposition)?;
    Ok(eigenvalues
        .iter()
        .map(|z| z.re.hypot(z.im))
        .fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Extended observability matrix Γ of A and C, with `blocks` blocks of rows C·Aⁱ.
    fn observability(a: &Mat<f64>, c: &Mat<f64>, blocks: usize) -> Mat<f64> {
        let mut block = c.clone();
        let mut gamma = Mat::zeros(blocks * c.nrows(), a.ncols());
        for i in 0..blocks {
            let mut rows = gamma.as_mut().subrows_mut(i * c.nrows(), c.nrows());
            rows.copy_from(&block);
            block = &block * a;
        }
        gamma
    }

    #[test]
    fn shift_invariance_returns_a_stable_matrix_and_tames_an_unstable_one() {
        let c = Mat::from_fn(1, 2, |_, j| [1.0, 0.5][j]);
        let stable = Mat::from_fn(2, 2, |i, j| [[0.9, 0.2], [-0.2, 0.8]][i][j]);
        let found = shift_solution(&observability(&stable, &c, 6), 1).unwrap();
        assert!((&found - &stable).norm_max() < 1e-12);

        let unstable = Mat::from_fn(2, 2, |i, j| [[1.1, 0.1], [0.0, 0.7]][i][j]);
        let tamed = shift_solution(&observability(&unstable, &c, 6), 1).unwrap();
        assert!(spectral_radius(&tamed).unwrap() < 1.0);
    }
}
