//! State of a training: the content of a checkpoint.

use super::epoch::Position;
use crate::learning::{Learner, Weights};

/// State of a training. With the settings, the data and the seed it determines all further steps, so a
/// checkpoint holds nothing else. Random numbers are drawn afresh from (seed, epoch, batch), so the generator
/// has no state of its own.
pub(super) struct State {
    pub(super) learner: Learner,
    pub(super) best: Weights,
    pub(super) progress: Position,
}
