//! Condition numbers of a regressor and of its parts.

use super::{LeastSquaresError, Triangle};
use faer::{Mat, MatRef};
use serde::{Deserialize, Serialize};

/// Condition numbers of a regressor and of its inertial, gravity and friction columns.
///
/// The parts are by kind of physical quantity (Han et al., "An iterative approach for accurate dynamic
/// model identification of industrial robots", IEEE T-RO 36(5), 2020, eq. 34: Y_i, Y_g, Y_f), so that units do
/// not mix inside a part. A part without columns is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SubRegressors {
    /// Condition number of all columns.
    pub whole: f64,
    /// Condition number of the columns of second moments and rotor inertias.
    pub inertial: Option<f64>,
    /// Condition number of the columns of first moments (and masses).
    pub gravity: Option<f64>,
    /// Condition number of the columns of friction and offset, in their own units, not normalised; none without such columns.
    pub friction: Option<f64>,
}

impl SubRegressors {
    /// Condition numbers from a triangle (of weighted rows, for the starred quantities of Han et al.) and the
    /// columns of each part.
    ///
    /// # Errors
    /// A column that does not exist; a decomposition that fails.
    pub fn of(
        triangle: &Triangle,
        inertial: &[usize],
        gravity: &[usize],
        friction: &[usize],
    ) -> Result<Self, LeastSquaresError> {
        let part = |columns: &[usize]| {
            if columns.is_empty() {
                return Ok(None);
            }
            condition_number(triangle.select(columns)?.r()).map(Some)
        };
        Ok(Self {
            whole: condition_number(triangle.r())?,
            inertial: part(inertial)?,
            gravity: part(gravity)?,
            friction: part(friction)?,
        })
    }

    /// Criterion of Han et al. (2020), Table II, for exciting trajectories: 10 cond(Y) + 5 cond(Y_i) + cond(Y_g) +
    /// cond(Y_f).
    pub fn criterion(&self) -> f64 {
        10.0 * self.whole
            + 5.0 * self.inertial.unwrap_or(0.0)
            + self.gravity.unwrap_or(0.0)
            + self.friction.unwrap_or(0.0)
    }

    /// Condition number of all columns scaled to unit norm, which does not depend on units.
    ///
    /// # Errors
    /// A decomposition that fails.
    pub fn scaled(triangle: &Triangle) -> Result<f64, LeastSquaresError> {
        let r = triangle.r();
        let norms: Vec<f64> = (0..r.ncols()).map(|j| r.col(j).norm_l2()).collect();
        let unit = Mat::from_fn(r.nrows(), r.ncols(), |i, j| {
            r[(i, j)] / if norms[j] > 0.0 { norms[j] } else { 1.0 }
        });
        condition_number(unit.as_ref())
    }
}

/// Ratio of the largest to the smallest singular value; 1e16 and more, or infinite, for a matrix that lacks rank, 1 for
/// one without columns.
///
/// # Errors
/// The decomposition does not converge.
pub fn condition_number(a: MatRef<'_, f64>) -> Result<f64, LeastSquaresError> {
    let values = a
        .singular_values()
        .map_err(|_| LeastSquaresError::Decomposition)?;
    Ok(match (values.first(), values.last()) {
        (Some(largest), Some(smallest)) if *smallest > 0.0 => largest / smallest,
        (Some(_), Some(_)) => f64::INFINITY,
        _ => 1.0,
    })
}
