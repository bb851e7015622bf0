//! Identification: from recorded motion and torque to parameters.

pub mod base;
pub mod feasible;
pub mod iterative;
pub mod least_squares;
pub mod residuals;
