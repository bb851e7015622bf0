//! Robot models, rigid-body dynamics, effects beyond the rigid body, and identification.
#![forbid(unsafe_code)]

pub mod dynamics;
pub mod effects;
pub mod robot;
