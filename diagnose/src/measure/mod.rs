//! What the causes do: shares, sizes, intervals, and what is left.

pub(crate) mod bounds;
pub mod confidence;
pub(crate) mod explain;
pub(crate) mod follow;
pub(crate) mod friction;
pub(crate) mod learned;
pub(crate) mod locate;
pub(crate) mod moved;
pub(crate) mod other_day;
pub(crate) mod quantities;
pub(crate) mod resonance;
pub(crate) mod shares;
pub(crate) mod verdict;
