//! Report of the preparation of a recording.

use super::cutoff::NoiseFloor;
use crate::TorqueFilter;
use serde::Serialize;

/// Source of a velocity or acceleration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// The recorded column, unchanged.
    Recorded,
    /// Derivative of the smoothed position; nothing was recorded.
    Derived,
    /// Derivative of the smoothed position instead of the recorded column.
    Replaced,
    /// Derivative of position and recorded velocity fused.
    Fused,
}

/// Report of the preparation, for reports and `model.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PrepareReport {
    /// Median sampling rate in Hz.
    pub rate_hz: f64,
    /// Rate of the fine grid in Hz.
    pub fine_hz: f64,
    /// Standard deviation of the time step over its median.
    pub jitter: f64,
    /// Cut-off in Hz; `None` when the positions are interpolated without a low-pass.
    pub cutoff_hz: Option<f64>,
    /// Whether the cut-off was given rather than chosen.
    pub cutoff_given: bool,
    /// Source of the velocity at the samples, per joint.
    pub velocity: Vec<Source>,
    /// Source of the acceleration at the samples.
    pub acceleration: Source,
    /// Noise floors found, per joint; empty for an interpolated recording.
    pub noise: Vec<NoiseFloor>,
    /// Filter applied to every prediction before it is compared with the recorded torque.
    pub torque_filter: Option<TorqueFilter>,
}
