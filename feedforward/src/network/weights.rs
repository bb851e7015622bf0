//! How the run-time keeps the weights of a network.

use serde::{Deserialize, Serialize};

/// Form in which the run-time keeps the weights of a recurrent unit; those of a fully connected one stay in single precision. The
/// file holds all of them in single precision, so that any form can be chosen anew.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Weights {
    /// Single precision.
    #[default]
    F32,
    /// Upper half of single precision: eight bits of mantissa. Sums are in single precision.
    Bf16,
    /// Whole numbers from −127 to 127 with one scale for each output of a matrix, on states of 16 bits. Weights that act on a
    /// unit's input columns stay in single precision: their inputs have no bound.
    Int8,
}

impl Weights {
    /// Whether it is single precision, which the file leaves unsaid.
    pub(super) fn is_f32(&self) -> bool {
        *self == Self::F32
    }
}
