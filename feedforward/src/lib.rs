//! Run-time of a trained model for control loops.
//!
//! [`Feedforward`] loads a model directory and predicts torque once per control period; [`Guard`] limits the
//! torque that is sent to the drives. [`network`] holds the learned part: error-learning units with their
//! normalisation, their bounds, their file format and allocation-free streaming inference. No training
//! framework is in the dependency tree.
// One module calls the processor's instructions for bytes: `network::packed::int8::vnni`.
#![deny(unsafe_code)]

pub mod clock;
mod dynamics;
pub mod guard;
pub mod inputs;
pub mod model_file;
pub mod network;
mod runtime;

pub use dynamics::Dynamics;
pub use guard::Guard;
pub use runtime::{Feedforward, LoadError, load_network};
