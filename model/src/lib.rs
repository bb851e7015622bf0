//! The pipeline behind `train` and `eval`: from recordings to an identified model, its directory on
//! disk, its predictions and its scores.
#![forbid(unsafe_code)]
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod baseline;
pub mod basic;
pub mod channel;
pub mod check;
pub mod cutoff;
pub mod design;
pub mod diagnostics;
pub mod dictionary;
pub mod directory;
pub mod estimators;
pub mod evaluation;
pub mod failure;
pub mod identification;
pub mod out_of_fold;
pub mod page;
pub mod physics_fit;
pub mod predict;
pub mod preparation;
pub mod residual;
pub mod selection;
pub mod session;
pub mod setup;
pub mod shrinkage;
pub mod tables;
pub mod torque_band;
pub mod units;
pub mod urdf;
