//! Measured effect of the causes: shares, sizes, intervals, residual, verdict.

pub(crate) mod bounds;
pub(crate) mod by_cause;
pub(crate) mod changed_parameters;
pub mod confidence;
pub(crate) mod explain;
pub(crate) mod friction;
pub(crate) mod learned;
pub(crate) mod locate;
pub(crate) mod other_day;
pub(crate) mod quantities;
pub(crate) mod resonance;
pub(crate) mod shares;
pub(crate) mod tracking;
pub(crate) mod verdict;
