//! Training of error-learning units: LSTM encoder, additive attention, LSTM re-encoder, dense output, one unit
//! per joint, on the residual torque of the physical model.
//!
//! Data are borrowed [`training::Samples`]; a unit's inputs are a list of their columns ([`inputs::InputSet`]).
//! [`training::train`] turns [`training::Job`]s into [`feedforward::network::Unit`]s, one network per core,
//! with the same bytes for any number of threads.
//!
//! Modules, optimiser, schedule and records are burn's (`learning`); forward and backward pass of a unit
//! are kernels of this crate (`engine`) behind one operation of a backend extension.
//!
//! Without the feature `networks`, on by default, nothing of burn is compiled: networks predict and are exported, and ridge
//! regressions are fitted, but no network is trained. The feature `trees` grows boosted trees to compare with.
#![deny(unsafe_code)]
// Backward passes are for who trains.
#![cfg_attr(not(feature = "networks"), allow(dead_code, unused_imports))]

mod config;
mod engine;
mod error;
pub mod inputs;
#[cfg(feature = "networks")]
mod learning;
pub mod onnx;
pub mod training;

pub use error::Error;
