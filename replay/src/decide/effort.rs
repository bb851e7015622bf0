//! How thoroughly the fits of a decision are made.

use crate::arm::STEP;
use crate::fit::Effort;

/// Integration step, s, of fits that only give start values or measure a cause's share.
pub const COARSE: f64 = 4e-3;

/// Effort of the first fit, from the given values.
pub(super) const FIRST: Effort = Effort {
    iterations: 25,
    gain: 0.5,
    step: COARSE,
};

/// Effort of a fit from that of a neighbouring set. A tenth of a nat changes nothing that is said.
pub(super) const NEXT: Effort = Effort {
    iterations: 10,
    gain: 0.1,
    step: COARSE,
};

/// Effort of fits that only choose where the rounds begin.
pub(super) const SKETCH: Effort = Effort {
    iterations: 5,
    gain: 0.5,
    step: COARSE,
};

/// Effort of the last fit of what is decided, at the step of what is scored. It starts from the coarse fit, which a
/// shorter step moves by little.
pub(super) const LAST: Effort = Effort {
    iterations: 2,
    gain: 0.1,
    step: STEP,
};
