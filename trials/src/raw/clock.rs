//! Clock of the simulation.

/// Rate of the simulated trace, Hz: that of the drive's current control.
pub const TRACE_HZ: f64 = 1000.0;
