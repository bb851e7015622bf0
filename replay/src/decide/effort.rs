//! How thoroughly the fits of a decision are made.

use crate::arm::STEP;
use crate::fit::Effort;

/// Step of fits whose values are a start for others, or stand for what a cause removes, s.
pub const COARSE: f64 = 4e-3;

/// The first fit from the given values, and fits from a neighbouring set. A tenth of a nat changes nothing that is said.
pub(super) const FIRST: Effort = Effort {
    iterations: 25,
    gain: 0.5,
    step: COARSE,
};

pub(super) const NEXT: Effort = Effort {
    iterations: 10,
    gain: 0.1,
    step: COARSE,
};

/// Fits that only choose where the rounds begin.
pub(super) const SKETCH: Effort = Effort {
    iterations: 5,
    gain: 0.5,
    step: COARSE,
};

/// Fits of one limit alone.
pub(super) const CUT: Effort = Effort {
    iterations: 3,
    gain: 0.5,
    step: COARSE,
};

/// The fit of what is decided, from its coarse fit: a shorter step moves it by little.
pub(super) const LAST: Effort = Effort {
    iterations: 2,
    gain: 0.1,
    step: STEP,
};
