//! What an effect is drawn for, and what was drawn.

use super::rehearsal::Rehearsal;
use super::withheld::Withheld;
use crate::arm::Arm;
use crate::reference::Session;

/// What a shape is drawn for.
pub struct Scene<'a> {
    /// The plain plant.
    pub arm: &'a Arm,
    /// Its motion.
    pub session: &'a Session,
    /// Its motion as commanded.
    pub rehearsal: &'a Rehearsal,
    /// Diagonal of its mass matrix in mid-region, kg·m².
    pub inertia: &'a [f64],
}

/// A shape and where and how large it is to be.
pub struct Shape {
    /// The effect.
    pub effect: Withheld,
    /// Joint on which its size is set; none: where it is largest.
    pub joint: Option<usize>,
    /// Share of that joint's torque.
    pub share: f64,
}
