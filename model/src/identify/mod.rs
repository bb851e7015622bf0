//! From prepared recordings to a physical model: rows, terms, estimators.

pub mod basic;
pub mod design;
pub mod diagnostics;
pub mod dictionary;
pub mod error;
pub mod estimators;
pub mod identification;
pub mod out_of_fold;
pub mod selection;
pub mod shrinkage;
pub(crate) mod steady;
pub mod target;
