//! Training of error-learning units: LSTM encoder, additive attention, LSTM re-encoder, dense output, one
//! unit per joint, on the torque that the physical model lacks.
//!
//! Data are borrowed [`training::Samples`]; what a unit sees is a list of their columns
//! ([`inputs::InputSet`]); [`training::train`] turns [`training::Job`]s into
//! [`feedforward::network::Unit`]s, one network per core, the same bytes whatever the number of threads.
#![deny(unsafe_code)]

mod engine;
mod error;
pub mod inputs;
pub mod onnx;
pub mod training;

pub use error::Error;
