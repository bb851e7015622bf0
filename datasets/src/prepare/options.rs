//! Options of the preparation.

/// Sampling rate, Hz, below which a recording is interpolated without low-pass: it was low-passed before it was
/// decimated, or nobody could derive accelerations from it anyway.
pub(super) const SLOW_HZ: f64 = 40.0;

/// Choice of where velocity and acceleration come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Derivatives {
    /// Derive from position; a recorded velocity that is consistent and less noisy is fused in.
    #[default]
    Auto,
    /// Derive from position alone.
    FromPosition,
    /// Take the recorded columns at the samples as they are, where there are any.
    Recorded,
}

/// Options of the preparation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrepareOptions {
    /// Cut-off of the low-pass in Hz (−6 dB after both passes); `None` chooses it from the data.
    pub cutoff_hz: Option<f64>,
    /// Least rate of the fine grid, about, Hz; default 100.
    pub fine_hz: f64,
    /// Source of velocity and acceleration.
    pub derivatives: Derivatives,
    /// Delay of the recorded torque against the motion, s: a property of the recording's channel. Predictions meet the
    /// recorded torque that much later; a control loop has no such delay.
    pub torque_delay: f64,
}

impl Default for PrepareOptions {
    fn default() -> Self {
        Self {
            cutoff_hz: None,
            fine_hz: 100.0,
            derivatives: Derivatives::Auto,
            torque_delay: 0.0,
        }
    }
}

impl PrepareOptions {
    /// The defaults with a given cut-off, Hz.
    pub fn low_passed(cutoff_hz: f64) -> Self {
        Self {
            cutoff_hz: Some(cutoff_hz),
            ..Self::default()
        }
    }

    /// Whether a recording at `rate_hz` is low-passed at all.
    pub fn low_passes(&self, rate_hz: f64) -> bool {
        self.cutoff_hz.is_some() || rate_hz >= SLOW_HZ
    }
}
