//! Run-time of a trained model: what a control loop needs and nothing else.
//!
//! [`network`] holds the learned part: error-learning units with their normalisation, their bounds,
//! their file format and allocation-free streaming inference. No training framework is in the
//! dependency tree.
#![forbid(unsafe_code)]

pub mod network;
