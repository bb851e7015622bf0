//! Base parameters as they are stored.

use serde::{Deserialize, Serialize};

/// One base parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BaseParameter {
    /// Name of the standard parameter that stands for it.
    pub name: String,
    /// The standard parameters that form it.
    pub formula: String,
    /// Identified value.
    pub value: f64,
    /// Standard deviation.
    pub std: f64,
    /// Standard deviation over the size of the value; none for a value of zero.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative_std: Option<f64>,
    /// Value of the nominal robot.
    pub nominal: f64,
    /// kg, kg·m or kg·m².
    pub unit: String,
}
