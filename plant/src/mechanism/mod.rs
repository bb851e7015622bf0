//! Mechanisms of real transmissions, motors and surroundings beyond a rigid body with viscous and Coulomb
//! friction. Each is modelled as the machine part that causes it, with its own state.
//!
//! This module holds the trait, and the mechanisms that several kinds of recording need. A mechanism that only
//! a sealed case withholds is defined with its effect in `trials`. The mechanisms do not use the terms of a
//! diagnosis; their forms are chosen to differ from those.

mod balance;
mod bristle;
mod friction;
mod gear;
mod rest;
mod ripple;
mod thermal;

pub use balance::{CoilSpring, GasStrut, Pins};
pub use bristle::Bristle;
pub use friction::{Drag, DragKind, Stribeck, StribeckKind};
pub use gear::{GearMesh, GearSpring};
pub use rest::{RestLaw, soft_sign};
pub use ripple::Ripple;
pub use thermal::WarmingGrease;

/// State of the plant during one integration step.
#[derive(Debug, Clone, Copy)]
pub struct Instant<'a> {
    /// Time in the middle of the step on the session's clock, s.
    pub t: f64,
    /// Duration of the integration step, s.
    pub dt: f64,
    /// Positions at the middle of the step.
    pub q: &'a [f64],
    /// Velocities at the middle of the step, extrapolated.
    pub v: &'a [f64],
    /// Accelerations of the step before.
    pub a: &'a [f64],
    /// Torque that each motor passed on to the links in the step before (its own less friction), N·m.
    pub load: &'a [f64],
}

/// A mechanism acting on the plant's joints (plant indices, which count joints that a transmission adds).
pub trait Mechanism: Send {
    /// Adds generalised forces that do not resist the velocity of this very step, N·m; positive drives the
    /// joint forwards.
    fn push(&mut self, _now: &Instant, _force: &mut [f64]) {}

    /// The joint whose velocity it resists, if any.
    fn joint(&self) -> Option<usize> {
        None
    }

    /// Resisting torque of [`Mechanism::joint`] if the step ended at velocity `v`, N·m; opposes forward motion
    /// when positive.
    fn resist(&self, _now: &Instant, _v: f64) -> f64 {
        0.0
    }

    /// Takes the states over the step, which ended at the velocities `v`.
    fn advance(&mut self, _now: &Instant, _v: &[f64]) {}

    /// Relative temperature of [`Mechanism::joint`], 1 at the steady state of its mean power, where it has one.
    fn warmth(&self) -> Option<f64> {
        None
    }
}
