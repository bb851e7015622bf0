//! Sizes of a cause in the report.

use super::unit::Unit;
use serde::Serialize;

/// A size of a cause.
#[derive(Clone, Debug, Serialize)]
pub struct Parameter {
    /// Name, that of docs/formats.md.
    pub name: String,
    /// Joint, where it belongs to one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// Value of the parameter.
    pub value: f64,
    /// Standard deviation; null where none was estimated.
    pub std: Option<f64>,
    /// Unit of the value.
    pub unit: Unit,
}

/// Value and standard deviation of the parameter `name`.
pub(super) fn size(parameters: &[Parameter], name: &str) -> Option<(f64, Option<f64>)> {
    let mut all = parameters.iter();
    all.find(|p| p.name == name).map(|p| (p.value, p.std))
}
