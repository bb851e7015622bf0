//! Sizes of a cause as the report gives them.

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
    /// Value.
    pub value: f64,
    /// Standard deviation; null where none was estimated.
    pub std: Option<f64>,
    /// Unit.
    pub unit: Unit,
}

/// The size of that name, and its deviation.
pub(super) fn size(parameters: &[Parameter], name: &str) -> Option<(f64, Option<f64>)> {
    let mut all = parameters.iter();
    all.find(|p| p.name == name).map(|p| (p.value, p.std))
}
