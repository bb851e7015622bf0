//! Sizes of a cause in the report.

use super::unit::Unit;
use serde::Serialize;

/// Size of a cause in the report: one value with its unit.
#[derive(Clone, Debug, Serialize)]
pub struct Parameter {
    /// Name of the size, as in docs/formats.md.
    pub name: String,
    /// Name of the joint, where the size belongs to one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// Value of the size, in `unit`.
    pub value: f64,
    /// Standard deviation; null where none was estimated.
    pub std: Option<f64>,
    /// Unit of value and deviation.
    pub unit: Unit,
}

/// Value and standard deviation of the parameter `name`.
pub(super) fn size(parameters: &[Parameter], name: &str) -> Option<(f64, Option<f64>)> {
    let mut all = parameters.iter();
    all.find(|p| p.name == name).map(|p| (p.value, p.std))
}
