//! Base parameters in stored form.

use serde::{Deserialize, Serialize};

/// Identified base parameter, as a model directory stores it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BaseParameter {
    /// Name of the standard parameter that represents the base parameter.
    pub name: String,
    /// Combination of standard parameters that the base parameter is, as a formula.
    pub formula: String,
    /// Identified value, in `unit`.
    pub value: f64,
    /// Standard deviation of the value, in `unit`.
    pub std: f64,
    /// Standard deviation over the size of the value; none for a value of zero.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative_std: Option<f64>,
    /// Value of the parameter for the nominal robot.
    pub nominal: f64,
    /// Unit of the parameter: kg, kg·m or kg·m².
    pub unit: String,
}
