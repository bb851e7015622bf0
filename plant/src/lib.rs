//! The "real" robot of proofs and tests: closed-loop forward simulation, with effects that simulators lack as mechanisms.
//!
//! - [`arm`], [`families`]: robots and their modifications.
//! - [`bodies`]: moving bodies of any kind of machine.
//! - [`mechanism`]: torques beyond rigid bodies with viscous and Coulomb friction.
//! - [`build`]: bodies, friction, mechanisms and measurement put together to a [`Plant`], which integrates them.
//! - [`control`], [`mod@reference`], [`run`]: controller, excitation, the loop.
//! - [`measure`]: from a perfect trace to a recording.
//!
//! Of `physics` only robots and rigid-body dynamics are used: nothing here shares a formula with the effects
//! that a diagnosis fits.
#![forbid(unsafe_code)]

pub mod arm;
pub mod bodies;
pub mod build;
pub mod control;
pub mod families;
mod integrate;
pub mod measure;
pub mod mechanism;
pub mod random;
pub mod reference;
pub mod run;

pub use integrate::{Friction, Plant};
