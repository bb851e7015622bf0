//! What is asked of a candidate, and the answer.

use crate::catalogue::effect::Effect;
use crate::catalogue::{Shape, Unit};

/// From which size on an effect at one place would be accepted.
#[derive(Clone, Debug, PartialEq)]
pub struct Visible {
    /// The effect.
    pub effect: Effect,
    /// Joints that it is named on.
    pub joints: Vec<usize>,
    /// Driving joint of a coupling.
    pub driver: Option<usize>,
    /// What the size is.
    pub quantity: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// Least size; none where no plausible one shows.
    pub from: Option<f64>,
    /// Root mean square of its torque at that size on the joint where it is strongest, N·m.
    pub torque: Option<f64>,
    /// Numbers of the shape for which it shows first.
    pub shape: Vec<Shape>,
}

/// A coefficient of a candidate.
#[derive(Clone, Copy)]
pub(super) struct Choice {
    /// Number of the candidate.
    pub candidate: usize,
    /// Number of its coefficient.
    pub place: usize,
}
