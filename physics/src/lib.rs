//! Robot models, rigid-body dynamics and effects beyond the rigid body.
//!
//! The crate `identify` estimates the parameters.
#![forbid(unsafe_code)]

#[cfg(feature = "batch")]
pub mod batch;
pub mod dynamics;
pub mod effects;
pub mod robot;
pub mod torque_model;
