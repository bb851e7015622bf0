//! What is seen in the residual itself: pushes, blows, lines of position, structure.

pub(crate) mod contact;
pub(crate) mod impacts;
pub(crate) mod order;
pub(crate) mod unknown;
