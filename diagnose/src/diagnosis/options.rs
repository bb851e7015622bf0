//! What a diagnosis is asked for.

use super::earlier::Earlier;
use crate::catalogue::choice::Choice;
use crate::settings::Settings;

/// What a diagnosis is to do.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// How gaps are weighed.
    pub settings: Settings,
    /// Which effects are looked for.
    pub effects: Choice,
    /// The robot's earlier recordings that the gap is measured from, where it is no simulator's.
    pub earlier: Option<Earlier>,
    /// Cut-off of the motion's low-pass, Hz; chosen from the fitted recording where none is given.
    pub cutoff_hz: Option<f64>,
    /// Train a compensator on what the causes leave.
    pub learn: bool,
    /// Simulate motion with the model as given and with the causes.
    pub simulate: bool,
    /// Surrogates of the recording that chance is told by; none are drawn for zero.
    pub surrogates: u64,
}
