//! What to do: the corrected model, and the motion that would tell more.

pub mod code;
pub mod directory;
pub mod next_motion;
pub mod patch;
pub mod visibility;
