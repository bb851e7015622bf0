//! Sums of products, their factors, and penalised fits on them.

pub(crate) mod batched_trials;
pub(crate) mod cholesky;
pub(crate) mod fit;
pub(crate) mod folds;
pub(crate) mod gram;
pub(crate) mod trial;
