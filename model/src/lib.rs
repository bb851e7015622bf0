//! The pipeline behind `train` and `eval`: from recordings to an identified model, its directory on
//! disk, its predictions and its scores.
#![forbid(unsafe_code)]
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod assemble;
pub mod baseline;
pub mod cross_fit;
pub mod directory;
pub mod evaluation;
pub mod failure;
pub mod identify;
pub mod inversion;
pub mod leaderboard;
pub mod loaded;
pub mod page;
pub mod payload;
pub mod physics_fit;
pub mod predict;
pub mod preparation;
pub mod residual;
pub mod session;
pub mod spread;
pub mod sums;
pub mod tables;
pub mod torque_channel;
pub mod urdf;
