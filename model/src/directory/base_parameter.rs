//! Base parameters in stored form.

use serde::{Deserialize, Serialize};

/// One base parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BaseParameter {
    /// Name of the standard parameter that represents it.
    pub name: String,
    /// Combination of standard parameters that it is.
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
    /// Unit: kg, kg·m or kg·m².
    pub unit: String,
}
