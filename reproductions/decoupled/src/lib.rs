//! One joint at a time, under its controller: the identification of "Closed-Loop Rigid Model Identification of an Industrial
//! Robot" (IFAC 2005), called the COMAU paper here.
//!
//! - [`joint`]: the model of a joint whose neighbours stand still, linear in its parameters; [`comau`]: the paper's six axes.
//! - [`reference`](mod@reference): periodic motion, slopes, bang-bang acceleration, trapezoids.
//! - [`simulation`]: the joint under a PID controller, with noise of its encoder and of its torque.
//! - [`run`]: what was commanded and recorded of one joint.
//! - [`moments`]: equations in which nothing that the loop feeds back is left; [`estimators`] solve them.
//! - [`gravity`], [`friction`]: runs at constant speed and at constant acceleration.
//! - [`repeats`]: mean, deviation and Student half-width over runs; [`study`]: biases over simulated draws; [`validation`].
#![forbid(unsafe_code)]
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod comau;
mod command;
mod command_line;
mod error;
pub mod estimators;
pub mod friction;
pub mod gravity;
pub mod joint;
pub mod moments;
pub mod reference;
pub mod repeats;
pub mod run;
pub mod simulation;
pub mod study;
pub mod validation;

pub use command_line::{command, command_line};
pub use error::DecoupledError;
