//! Options of a diagnosis.

use super::earlier::Earlier;
use crate::catalogue::choice::Choice;
use crate::settings::Settings;

/// Options of a diagnosis.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Thresholds that decide what the diagnosis says.
    pub settings: Settings,
    /// Effects that are searched.
    pub effects: Choice,
    /// Earlier recordings of the robot to which the gap is measured instead of a simulator's model.
    pub earlier: Option<Earlier>,
    /// Cut-off of the motion's low-pass, Hz; chosen from the fitted recording where none is given.
    pub cutoff_hz: Option<f64>,
    /// Whether to train a compensator on the residual beside the causes.
    pub learn: bool,
    /// Whether to simulate motion with the model as given and with the causes.
    pub simulate: bool,
    /// Number of surrogates for the chance level; zero for none.
    pub surrogates: u64,
}
