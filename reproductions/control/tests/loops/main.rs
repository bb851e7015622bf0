//! Loops under a controller.

mod collision;
mod tracking;
