//! The commands, one file each.

pub mod control;
pub mod friction;
pub mod identify;
pub mod simulate;
pub mod study;

use crate::DecoupledError;
use crate::comau::axes;
use crate::joint::Joint;

/// A simulated axis by its number, from 1.
fn axis(number: usize) -> Result<Joint, DecoupledError> {
    let all = axes();
    let found = number.checked_sub(1).and_then(|i| all.get(i));
    found.copied().ok_or(DecoupledError::Axis {
        axis: number,
        count: all.len(),
    })
}

/// JSON with a line's end.
fn json(value: &impl serde::Serialize) -> String {
    let mut text = serde_json::to_string_pretty(value).unwrap_or_default();
    text.push('\n');
    text
}
