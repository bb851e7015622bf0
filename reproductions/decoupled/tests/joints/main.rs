//! Single joints in closed loop.

mod biases;
mod program;
