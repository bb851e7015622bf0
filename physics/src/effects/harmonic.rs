//! Torque periodic in the joint's own position.

use serde::{Deserialize, Serialize};

/// sin(order·q) or cos(order·q).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Harmonic {
    /// Order: periods per joint revolution; not necessarily whole.
    pub order: f64,
    /// Phase of the wave: sine or cosine.
    pub phase: Phase,
}

/// Phase of a periodic torque: sine or cosine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Sine of the position: sin(order·q).
    Sin,
    /// Cosine of the position: cos(order·q).
    Cos,
}

impl Harmonic {
    /// Column at position `q` in rad.
    pub fn at(&self, q: f64) -> f64 {
        match self.phase {
            Phase::Sin => (self.order * q).sin(),
            Phase::Cos => (self.order * q).cos(),
        }
    }

    pub(super) fn label(&self) -> String {
        match self.phase {
            Phase::Sin => format!("sin({} q)", self.order),
            Phase::Cos => format!("cos({} q)", self.order),
        }
    }
}
