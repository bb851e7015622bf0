//! The "real" robot of proofs and tests: closed-loop forward simulation with what simulators lack as mechanisms.
//!
//! - [`arm`], [`families`]: robots, and how they can be altered.
//! - [`bodies`]: what moves, whatever kind of machine it is.
//! - [`mechanism`]: what a robot does beyond rigid bodies with viscous and Coulomb friction.
//! - [`build`]: bodies, friction, mechanisms and measurement put together to a [`Plant`], which integrates them.
//! - [`control`], [`mod@reference`], [`run`]: controller, excitation, the loop.
//! - [`measure`]: from what happened to a recording.
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
