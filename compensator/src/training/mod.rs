//! Training of one unit, of an ensemble of seeds, and of all units on all cores; ridge regression and boosted trees on the
//! same windows, to compare with.

mod batches;
#[cfg(feature = "networks")]
mod checkpoint;
#[cfg(feature = "networks")]
mod ensemble;
mod epoch;
mod folds;
#[cfg(feature = "trees")]
mod grown;
mod job;
mod judge;
mod predict;
mod progress;
mod ridge;
mod samples;
#[cfg(feature = "networks")]
mod state;
#[cfg(feature = "networks")]
mod trainer;
mod trees;

pub use crate::config::{Loss, Schedule, Training, UnitConfig};
#[cfg(feature = "networks")]
pub use crate::learning::Tensors;
#[cfg(feature = "networks")]
pub use ensemble::train;
pub use epoch::Epoch;
pub use folds::{Fold, folds};
#[cfg(feature = "trees")]
pub use grown::{choose_trees, grow_trees};
pub use job::{Control, Job, Report, Trained, judge};
pub use predict::predict;
pub use progress::Progress;
pub use ridge::{choose_ridge, fit_ridge, train_ridge};
pub use samples::{Samples, Split};
pub use trees::Trees;

/// Networks are trained in builds with the feature `networks` alone; others predict with those that are there.
///
/// # Errors
/// [`crate::Error::Networks`] in a build without it.
pub fn trainable() -> Result<(), crate::Error> {
    match cfg!(feature = "networks") {
        true => Ok(()),
        false => Err(crate::Error::Networks),
    }
}

/// Error: without the feature `networks` nothing is trained.
///
/// # Errors
/// [`crate::Error::Networks`], always.
#[cfg(not(feature = "networks"))]
pub fn train(_: &[Job], _: &Control) -> Result<Vec<Trained>, crate::Error> {
    Err(crate::Error::Networks)
}
