//! Input of a diagnosis: model and recordings, checked and on their clocks.

pub(crate) mod before;
pub mod budget;
pub(crate) mod frames;
pub(crate) mod given;
pub(crate) mod recordings;
pub(crate) mod reversal;
