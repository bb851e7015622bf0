//! Dynamics and descriptions of robots, against Pinocchio and against themselves.

mod descriptions;
mod mjcf;
mod pinocchio;
mod properties;
mod urdf;
