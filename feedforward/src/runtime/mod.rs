//! Torque feedforward from a model directory.

mod error;
mod load;
mod model;
mod residual;

pub use error::LoadError;
pub use load::load_network;
pub use model::Feedforward;
