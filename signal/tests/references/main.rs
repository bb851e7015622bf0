//! Filters and regressions against SciPy and others.

mod loess;
mod scipy;
