//! Learning: burn's module, optimiser, schedule and records around the engine's kernels.
//!
//! Cost and gradient of a unit are one operation of a backend extension ([`operation`]): burn sees a flat
//! parameter and its gradient, the kernels see slices, nothing is copied. AdamW in one pass ([`adamw`]) is a
//! second one. All of it runs on burn's `flex` backend without its thread pool; networks are trained in
//! parallel, one per core. Where the kernels cannot run, on a GPU, the unit is composed of burn's own
//! operations ([`composed`]).

mod adamw;
mod batch;
mod composed;
mod learner;
mod loss;
mod operation;
mod schedule;
mod tensors;
mod weights;

#[cfg(test)]
mod oracle_tests;

pub(crate) use batch::Batch;
pub(crate) use composed::Means;
pub(crate) use learner::{Learner, Records};
pub(crate) use operation::NotFinite;
pub use tensors::Tensors;
pub(crate) use weights::Weights;
