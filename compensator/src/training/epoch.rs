//! Progress of a network's training.

use serde::{Deserialize, Serialize};

/// Position of the training loop of one network.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Position {
    /// Number of finished batches of the running epoch.
    pub(super) batch: usize,
    /// Weighted sum of the costs in these batches.
    pub(super) loss: f64,
    /// Sum of the weights in these batches.
    pub(super) weight: f64,
    /// Errors after each finished epoch.
    pub(super) history: Vec<Epoch>,
    /// Index of the epoch with the smallest validation error, from 0.
    pub(super) best_epoch: usize,
    /// Number of epochs since the one with the smallest validation error, 0 right after it. Training ends when it exceeds
    /// the patience.
    pub(super) stale: usize,
    /// Whether the training has ended.
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
