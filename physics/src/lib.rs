//! Robot models, rigid-body dynamics, effects beyond the rigid body, and identification.
#![forbid(unsafe_code)]

pub mod dynamics;
pub mod effects;
pub mod excitation;
pub mod identify;
pub mod robot;
pub mod torque_model;
