//! Error-learning units: the part of the torque that the physical model lacks, one unit per joint.
//!
//! A [`Unit`] maps a short history of motion features of its input columns to one residual torque.
//! Its [`Architecture`] is the published one (LSTM encoder, additive attention, LSTM re-encoder, dense
//! output; Wang et al., "A LSTM-based uncertainty compensation model", equations 14–24) or a fully
//! connected network, which with no hidden layer is a linear model.
//!
//! Units are trained by the `compensator` crate, stored by [`Compensator::save`], and evaluated
//! sample by sample by [`Stream`], which allocates nothing after construction.

mod activation;
mod architecture;
mod bounds;
mod error;
mod file;
#[cfg(test)]
mod fixture;
mod normaliser;
mod packed;
mod perceptron;
mod recurrent;
mod stream;
mod unit;
mod weights;

pub use activation::{exp, sigmoid, tanh};
pub use architecture::{Architecture, Memory, Recurrent, Tensor};
pub use bounds::{Bounds, Fade, Inside};
pub use error::Error;
pub use file::{FORMAT, VERSION};
pub use normaliser::{Normalisation, Normaliser};
pub use stream::{Stream, UnitStream};
pub use unit::{Compensator, Unit};
pub use weights::Weights;
