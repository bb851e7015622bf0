//! Forward and backward passes, written by hand over matrix kernels and checked against PyTorch.
//!
//! Everything is generic over f32 (training) and f64 (gradient checks). Sequences are time-major: the
//! block of step t holds one row per element of the batch.

mod attention;
mod lstm;
mod matmul;
mod network;
mod perceptron;
mod real;
mod recurrent;
mod span;

#[cfg(test)]
mod gradient_tests;

pub(crate) use network::Network;
pub(crate) use real::{Real, dot};
pub(crate) use span::{Dropout, Span};
