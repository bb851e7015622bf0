//! Discrepancy in motion between a robot and its simulator. Recorded commands are replayed on the simulator, and the
//! simulated motion is compared with the recorded one. The effects that the simulator lacks are found from the
//! difference. No torque is needed.
#![forbid(unsafe_code)]

pub mod arm;
pub mod catalogue;
pub mod check;
pub mod command;
pub mod decide;
pub mod diagnosis;
pub mod fit;
mod floor;
pub mod friction;
pub mod given;
pub mod input;
pub mod job;
mod known;
pub mod page;
pub mod parameter;
pub mod patch;
pub mod place;
pub mod schema;
pub mod score;
pub mod simulate;
pub mod smooth;
pub mod tracks;
mod unlimited;
pub mod words;

pub use diagnosis::Options;
pub use input::Subject;
pub use job::{Done, Job, ReplayError, replay, replay_since};
