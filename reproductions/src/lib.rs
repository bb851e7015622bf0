//! Systems of the source documents that no user's daily path takes: machines without a description by links, single joints under
//! their controller, and what a torque model is worth in simulated loops. docs/sources.md lists them with published figures.
#![forbid(unsafe_code)]

pub use {control, decoupled, machines};
