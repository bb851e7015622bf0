//! What to do: the corrected model, and the motion that would tell more.

pub mod next_motion;
pub mod patch;
