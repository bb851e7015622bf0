//! Progress of a network's training.

use serde::{Deserialize, Serialize};

/// Position of the training loop.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Position {
    /// Finished batches of the running epoch and their summed cost and weight.
    pub(super) batch: usize,
    pub(super) loss: f64,
    pub(super) weight: f64,
    pub(super) history: Vec<Epoch>,
    pub(super) best_epoch: usize,
    /// Number of epochs since the best one.
    pub(super) stale: usize,
    pub(super) finished: bool,
}

/// Errors of a network after one epoch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Epoch {
    /// Mean cost of the training samples, in units of the normalised target, with dropout.
    pub train_loss: f64,
    /// Root mean square error of the validation samples, N·m, without dropout.
    pub validation_rmse: Option<f64>,
}
