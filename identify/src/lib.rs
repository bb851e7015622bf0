//! Identification: from recorded motion and torque to the parameters of a robot's dynamics, and motions that excite them.
//!
//! The numerics alone, on rows or on sums of products; which rows a recording gives is the caller's business. In the
//! order of use: [`excitation`] finds a motion, [`base`] which parameters a motion can tell at all, [`least_squares`]
//! and [`iterative`] estimate them, [`total_least_squares`] does where columns are noisy too, [`feasible`] holds links to
//! possible bodies, [`residuals`] judges what is left.
#![forbid(unsafe_code)]

pub mod base;
pub mod excitation;
pub mod feasible;
pub mod iterative;
pub mod least_squares;
pub mod residuals;
pub mod total_least_squares;
