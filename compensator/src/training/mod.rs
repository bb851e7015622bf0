//! Training of one unit, of an ensemble of seeds, and of all units on all cores; ridge regression and boosted trees on the
//! same windows, to compare with.

mod batches;
mod checkpoint;
mod ensemble;
mod folds;
mod judge;
mod predict;
mod progress;
mod ridge;
mod samples;
mod state;
mod trainer;
mod trees;

pub use crate::config::{Loss, Schedule, Training, UnitConfig};
pub use crate::learning::Tensors;
pub use ensemble::{Control, Job, Report, Trained, judge, train};
pub use folds::{Fold, folds};
pub use predict::predict;
pub use progress::Progress;
pub use ridge::{choose_ridge, fit_ridge, train_ridge};
pub use samples::{Samples, Split};
pub use state::Epoch;
pub use trees::{Trees, choose_trees, grow_trees};
