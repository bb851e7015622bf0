//! Normalisation of channels as in both listings of the paper.

use ndarray::{Array2, ArrayView2, Axis};
use serde::{Deserialize, Serialize};

/// Mean and standard deviation of each channel of the training data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Normalisation {
    /// Mean of each channel, in the channel's unit.
    pub mean: Vec<f64>,
    /// Standard deviation per channel (of the sample, n − 1); 1 for a channel that never varies, so that it
    /// becomes zero.
    pub std: Vec<f64>,
}

impl Normalisation {
    /// Normalisation from a table (samples, channels).
    pub(super) fn of(table: ArrayView2<f64>) -> Self {
        let columns = || table.axis_iter(Axis(1));
        let mean: Vec<f64> = columns().map(|c| c.mean().unwrap_or(0.0)).collect();
        let std = columns().zip(&mean).map(|(column, mean)| {
            let deviation = if column.len() > 1 {
                column.std(1.0)
            } else {
                0.0
            };
            // A constant's computed deviation is rounding.
            if deviation > 1e-12 * mean.abs() {
                deviation
            } else {
                1.0
            }
        });
        Self {
            std: std.collect(),
            mean,
        }
    }

    /// Normalised values (x − mean)/std per channel.
    pub(super) fn apply(&self, table: ArrayView2<f64>) -> Array2<f64> {
        Array2::from_shape_fn(table.dim(), |(k, c)| {
            (table[(k, c)] - self.mean[c]) / self.std[c]
        })
    }

    /// Physical values x·std + mean per channel.
    pub(super) fn undo(&self, table: ArrayView2<f64>) -> Array2<f64> {
        Array2::from_shape_fn(table.dim(), |(k, c)| {
            table[(k, c)] * self.std[c] + self.mean[c]
        })
    }
}
