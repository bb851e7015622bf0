//! The gap in motion: recorded commands are replayed on the robot's simulator, the simulated motion is compared with the
//! recorded one, and the effects that the simulator lacks are found from the difference. No torque is needed.
#![forbid(unsafe_code)]

pub mod arm;
pub mod catalogue;
pub mod check;
pub mod command;
mod command_line;
pub mod decide;
pub mod diagnosis;
pub mod fit;
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
pub mod tracks;
pub mod words;

pub use command_line::{Arguments, run};
