//! Identification: from recorded motion and torque to the parameters of a robot's dynamics, and motions that excite them.
//!
//! The numerics alone, on rows or on sums of products; the caller makes the rows from a recording. In the order
//! of use: [`excitation`] finds a motion, [`base`] the identifiable parameters, [`least_squares`] and
//! [`iterative`] estimate them. [`total_least_squares`] does so where columns are noisy too, [`feasible`] holds
//! links to possible bodies, [`residuals`] tests the residual.
#![forbid(unsafe_code)]

pub mod base;
pub mod excitation;
pub mod feasible;
pub mod iterative;
pub mod least_squares;
pub mod residuals;
pub mod total_least_squares;
