//! Coefficient whose visibility is determined, and the result.

use crate::catalogue::effect::Effect;
use crate::catalogue::{Shape, Unit};

/// Least size from which an effect at one place would be accepted.
#[derive(Clone, Debug, PartialEq)]
pub struct Visible {
    /// Effect of the catalogue whose visibility is stated.
    pub effect: Effect,
    /// Indices of the joints that the effect is named on.
    pub joints: Vec<usize>,
    /// Index of the driving joint; none but for a coupling.
    pub driver: Option<usize>,
    /// Name of the quantity whose size is stated.
    pub quantity: &'static str,
    /// Unit of the size `from`.
    pub unit: Unit,
    /// Least size at which the effect is accepted, in `unit`; none where no plausible size is.
    pub from: Option<f64>,
    /// Root mean square torque of the effect at the size `from`, on the joint where it is strongest, N·m.
    pub torque: Option<f64>,
    /// Shape parameters for which the least size is smallest.
    pub shape: Vec<Shape>,
}

/// A coefficient of a candidate.
#[derive(Clone, Copy)]
pub(super) struct Choice {
    /// Index of the candidate that the coefficient belongs to.
    pub candidate: usize,
    /// Index of its coefficient.
    pub place: usize,
}
