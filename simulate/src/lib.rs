//! The "real" robot of proofs and tests: closed-loop forward simulation with the effects that simulators lack, as
//! mechanisms.
//!
//! - [`arm`], [`families`]: robots, and how a plant is built from one.
//! - [`mechanism`]: what a robot does beyond rigid bodies with viscous and Coulomb friction.
//! - `effects`: what a sealed case can withhold, one file per effect.
//! - [`plant`], [`control`], [`mod@reference`], [`run`]: integration, controller, excitation, the loop.
//! - [`cases`]: sealed diagnosis cases with one withheld effect and their answers.
//! - [`protocols`]: recordings as the source papers made theirs.
//! - [`raw`]: recordings as a controller logs them, with what is true of their torque channel.
//!
//! Of `physics` only robots and rigid-body dynamics are used: nothing here shares a formula with the effects
//! that a diagnosis fits.
#![forbid(unsafe_code)]

pub mod arm;
mod build;
pub mod cases;
pub mod control;
mod effects;
mod error;
pub mod families;
mod measure;
pub mod mechanism;
pub mod plant;
pub mod protocols;
mod random;
pub mod raw;
pub mod reference;
pub mod run;

pub use error::SimulateError;
pub use protocols::{Protocol, Simulated, cached};
