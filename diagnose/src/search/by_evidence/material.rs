//! What the search by evidence gets of a recording.

use super::posterior::Posterior;
use crate::motion::frame::Frame;
use crate::search::tables::Tables;
use ndarray::Array2;

/// Columns and gap on the fitted rows.
pub(in crate::search) struct Material<'a> {
    /// Values of the columns.
    pub tables: &'a Tables,
    /// Features of the unknown torque by joint, shape (features, rows).
    pub features: Vec<Array2<f64>>,
    /// Torque gap, shape (rows, joints).
    pub y: &'a Array2<f64>,
    /// Residual of the parameters alone, shape (rows, joints).
    pub residual: Array2<f64>,
    /// Weight of each row, shape (rows, joints).
    pub weight: &'a Array2<f64>,
    /// Fitted recording.
    pub frame: &'a Frame,
    /// Typical torque of each joint, N·m (N).
    pub torque: &'a [f64],
}

impl Material<'_> {
    /// Gap that the coefficients of a posterior leave, shape (rows, joints).
    pub(super) fn left(&self, posterior: &Posterior) -> Array2<f64> {
        let mut out = self.y.clone();
        for (&v, b) in posterior.variables.iter().zip(&posterior.beta) {
            for (j, mut left) in out.columns_mut().into_iter().enumerate() {
                if let Some(column) = self.tables.column(j, v) {
                    left.scaled_add(-b, &column);
                }
            }
        }
        out
    }
}
