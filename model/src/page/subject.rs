//! Subject of a page.

use crate::baseline::published::Published;
use datasets::Recording;
use datasets::metrics::Row;
use ndarray::Array2;
use signal::Motion;

/// Recording with a model's predictions and scores, as a page shows it.
pub struct Subject<'a> {
    /// Recording that the page shows.
    pub recording: &'a Recording,
    /// Motion of the recording at the recorded samples.
    pub motion: &'a Motion,
    /// Torque of the whole model, N·m (N), shape (samples, joints).
    pub torque: &'a Array2<f64>,
    /// Scores of each model and scope.
    pub rows: &'a [Row],
    /// Conditions of the figures, as text.
    pub notes: &'a [String],
    /// Published results to stand beside the scores.
    pub published: &'a [&'static Published],
}
