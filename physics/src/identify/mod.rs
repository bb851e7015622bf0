//! Identification: from recorded motion and torque to parameters.

pub mod least_squares;
