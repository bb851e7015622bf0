//! Traces that a residual shows by itself: pushes, blows, periodic lines over position, structure.

pub(crate) mod contact;
pub(crate) mod impacts;
pub(crate) mod order;
pub(crate) mod unknown;
