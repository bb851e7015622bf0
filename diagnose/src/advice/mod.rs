//! Advice: corrected model, generated code, next motion, visibility of effects.

pub mod code;
pub mod directory;
pub mod next_motion;
pub mod patch;
pub mod visibility;
