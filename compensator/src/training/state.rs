//! Where a training stands: all that a checkpoint holds.

use super::epoch::Position;
use crate::learning::{Learner, Weights};

/// Everything that the rest of the training depends on: with the settings, the data and the seed it is
/// all that a checkpoint holds. Random numbers are drawn afresh from (seed, epoch, batch), so the
/// generator has no state of its own.
pub(super) struct State {
    pub(super) learner: Learner,
    pub(super) best: Weights,
    pub(super) progress: Position,
}
