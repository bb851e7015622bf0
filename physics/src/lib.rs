//! Robot models, rigid-body dynamics and effects beyond the rigid body.
//!
//! How their parameters are found stands in the crate `identify`.
#![forbid(unsafe_code)]

#[cfg(feature = "batch")]
pub mod batch;
pub mod dynamics;
pub mod effects;
pub mod robot;
pub mod torque_model;
