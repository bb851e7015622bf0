//! The pipeline behind `train` and `eval`: from recordings to an identified model, its directory on
//! disk, its predictions and its scores.
#![forbid(unsafe_code)]

pub mod baseline;
pub mod design;
pub mod dictionary;
pub mod folds;
pub mod identification;
pub mod metrics;
pub mod selection;
pub mod session;
