//! What was done to a recording.

use super::cutoff::NoiseFloor;
use crate::TorqueFilter;
use serde::Serialize;

/// Where a derivative comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// The recorded column as it is.
    Recorded,
    /// Derivative of the smoothed position; nothing was recorded.
    Derived,
    /// Derivative of the smoothed position instead of the recorded column.
    Replaced,
    /// Derivative of position and recorded velocity fused.
    Fused,
}

/// What was done, for reports and `model.json`.
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
    /// Where velocity at the samples comes from, per joint.
    pub velocity: Vec<Source>,
    /// Where acceleration at the samples comes from.
    pub acceleration: Source,
    /// Noise floors found, per joint; empty for an interpolated recording.
    pub noise: Vec<NoiseFloor>,
    /// Filter applied to every prediction before it is compared with the recorded torque.
    pub torque_filter: Option<TorqueFilter>,
}
