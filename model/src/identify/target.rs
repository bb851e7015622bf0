//! Torque to which a model is fitted.

use crate::identify::error::IdentifyError;
use datasets::prepare::Prepared;
use datasets::{Folds, Recording};
use ndarray::Array2;
use physics::robot::Robot;

/// Torque of the samples to fit, and their folds.
pub struct Target<'a> {
    /// Measured torque of each recording, N·m (N), shape (samples, joints).
    pub tau: Vec<&'a Array2<f64>>,
    /// Folds of the rows for cross-validation.
    pub folds: Folds,
}

/// Measured torque of a recording, shape (samples, joints), minus that of a known counterbalance or spring,
/// which is not identified. `part` is the prepared recording.
///
/// # Errors
/// No torque was recorded.
pub fn identified(
    robot: &Robot,
    recording: &Recording,
    part: &Prepared,
) -> Result<Array2<f64>, IdentifyError> {
    let tau = recording
        .tau
        .as_ref()
        .ok_or_else(|| IdentifyError::NoTorque(recording.source.clone()))?;
    let mut known = Array2::zeros((part.at_samples.len(), robot.dof()));
    for p in robot.passive() {
        let q = part.fine.q.column(p.joint());
        let fine: Vec<f64> = q.iter().map(|&q| p.torque(q)).collect();
        let mut column = known.column_mut(p.joint());
        column += &ndarray::Array1::from(part.to_samples(&fine));
    }
    Ok(tau - &known)
}
