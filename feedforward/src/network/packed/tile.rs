//! Sizes of what a product takes at once.

/// Number of outputs computed together; their accumulators stay in vector registers over all inputs.
pub(super) const TILE: usize = 32;
/// Largest number of rows for which a weight is read once.
pub(super) const ROWS: usize = 4;
