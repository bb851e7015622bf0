//! Coefficient whose visibility is determined, and the result.

use crate::catalogue::effect::Effect;
use crate::catalogue::{Shape, Unit};

/// Least size from which an effect at one place would be accepted.
#[derive(Clone, Debug, PartialEq)]
pub struct Visible {
    /// Effect of the catalogue.
    pub effect: Effect,
    /// Joints that it is named on.
    pub joints: Vec<usize>,
    /// Driving joint of a coupling.
    pub driver: Option<usize>,
    /// Name of the quantity whose size is stated.
    pub quantity: &'static str,
    /// Unit of the size.
    pub unit: Unit,
    /// Least size; none where no plausible size is accepted.
    pub from: Option<f64>,
    /// Root mean square of its torque at that size on the joint where it is strongest, N·m.
    pub torque: Option<f64>,
    /// Shape parameters for which the least size is smallest.
    pub shape: Vec<Shape>,
}

/// A coefficient of a candidate.
#[derive(Clone, Copy)]
pub(super) struct Choice {
    /// Index of the candidate.
    pub candidate: usize,
    /// Index of its coefficient.
    pub place: usize,
}
