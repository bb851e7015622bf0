//! How to identify.

/// Cut-off where none is given, Hz: that of the manual's example of a result.
pub const FILTER_HZ: f64 = 20.0;

/// Part of an axis's highest speed below which a sample is left out. The manual prints thresholds of 0.03 to 0.06 rad/s for motions of
/// 0.14 to 0.6 rad/s and no rule; a tenth is of that size.
pub const SHARE: f64 = 0.1;

/// Part of an axis's speed limit above which the semi-static model leaves a sample out.
pub const SLOW: f64 = 0.15;

/// Settings of an identification.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings {
    /// Cut-off of the low-pass of position and torque, Hz; [`FILTER_HZ`] where none is given.
    pub filter_hz: Option<f64>,
    /// Speed of each axis below which samples are left out, rad/s or m/s; [`SHARE`] of its highest where none is given.
    pub thresholds: Option<Vec<f64>>,
    /// Speed above which samples are left out by the semi-static model; [`SLOW`] of the axis's limit where none is given.
    pub ceilings: Option<Vec<f64>>,
}
