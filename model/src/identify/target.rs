//! What a model is fitted to.

use datasets::Folds;
use ndarray::Array2;

/// Torque and scope of the samples to fit.
pub struct Target<'a> {
    /// Measured torque of each recording, shape (samples, joints).
    pub tau: Vec<&'a Array2<f64>>,
    /// How the rows are dealt for cross-validation.
    pub folds: Folds,
}
