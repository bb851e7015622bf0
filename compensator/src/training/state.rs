//! State of a training: the content of a checkpoint.

use super::epoch::Position;
use crate::learning::{Learner, Weights};

/// State of one network's training, which is the content of a checkpoint.
///
/// With settings, data and seed it determines all further steps. Random numbers are drawn from (seed, epoch, batch), so
/// that no generator state is needed.
pub(super) struct State {
    /// Parameters, optimiser and schedule.
    pub(super) learner: Learner,
    /// Parameters with the smallest validation error so far.
    pub(super) best: Weights,
    /// Position of the training loop.
    pub(super) progress: Position,
}
