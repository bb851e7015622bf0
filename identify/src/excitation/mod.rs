//! Exciting trajectories: motions within the robot's limits from which parameters can be identified well.
//!
//! The one owner of designed motion: the command `excite` and the next motion of a diagnosis call it.
//!
//! | file | content |
//! |---|---|
//! | `limits` | limits of the joints' motion, and checks of motions that cannot be done within them |
//! | `series` | sums of sines |
//! | `tool` | region of the tool |
//! | `room` | limits, series and region together as the room of periodic motions |
//! | `search` | periodic motions of least cost (Swevers et al., IEEE Trans. Robotics and Automation 13(5), 1997; Han et al., IEEE T-RO 36(5), 2020) |
//! | `sines` | one sine per joint (softMC manual) |
//! | `model_free` | random motions (KR300 benchmark) |
//! | `criterion` | optimality criteria of motions |
//! | `stack` | motions that complement each other |
//! | `information` | information of a motion on the parameters |
//!
//! Deterministic: the same seed gives the same motion.

mod criterion;
mod error;
mod information;
mod limits;
pub mod model_free;
mod room;
mod rows;
mod search;
mod series;
mod sines;
mod stack;
#[cfg(test)]
mod tests;
mod tool;

pub use criterion::{Criterion, Excitation, Goal, Separation, torque};
pub use error::ExcitationError;
pub use information::deviations;
pub use limits::{MotionLimits, Rest};
pub use model_free::model_free;
pub use room::{Bounds, Room};
pub use rows::BaseRows;
pub use search::{Found, SearchOptions, optimise};
pub use series::{Series, State};
pub use sines::{SineOptions, sines};
pub use stack::{Stack, stack};
pub use tool::{Region, ToolRoom};
