//! One reason.

use serde::{Deserialize, Serialize};

/// What can be wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// An axis moves too slowly for its inertia to show.
    TooSlow,
    /// The torque is cut at a limit.
    Saturated,
    /// Fewer than three cycles.
    TooShort,
    /// An axis covers too little of its range.
    RegionTooSmall,
    /// The torque of one axis is in another scale than the model's, or has another sign.
    TorqueFactor,
    /// Another torque model of the same kind of machine fits far better.
    WrongModel,
    /// Noise of the size of the torque.
    Noise,
}

/// One reason.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reason {
    /// What.
    pub kind: Kind,
    /// Axis, by index; none for the whole machine.
    pub axis: Option<usize>,
    /// The number behind it, in the unit that `message` names.
    pub value: f64,
    /// What is wrong and what to do, as a sentence.
    pub message: String,
}
