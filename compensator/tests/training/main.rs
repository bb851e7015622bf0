//! Training on a synthetic residual: hysteresis of a joint, which only history explains.

mod checkpoints;
mod hysteresis;
mod learning;
mod refusals;
mod ridge;
mod tensors;
#[cfg(feature = "trees")]
mod trees;
