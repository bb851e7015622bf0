//! Where the gap between a simulator's torque and a real robot's lies, which unmodelled effects cause
//! it, and how far it shrinks.
#![forbid(unsafe_code)]

pub mod candidates;
pub mod cholesky;
pub mod dictionary;
pub mod effect;
pub mod fit;
pub mod frame;
pub mod gram;
pub mod objective;
pub mod scene;
pub mod select;
