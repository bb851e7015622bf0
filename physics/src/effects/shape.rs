//! Friction shapes that load and position scale.

use super::{Dahl, Sliding};
use serde::{Deserialize, Serialize};

/// A friction of unit size that something else scales.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FrictionShape {
    /// Friction of the present velocity.
    Sliding(Sliding),
    /// Friction with memory of displacement.
    Dahl(Dahl),
}

impl FrictionShape {
    /// Torque for a parameter of one at velocity `qd` after a displacement `dq`; `z` is the memory.
    pub(super) fn step(&self, z: &mut f64, qd: f64, dq: f64) -> f64 {
        match self {
            FrictionShape::Sliding(f) => f.at(qd),
            FrictionShape::Dahl(dahl) => {
                *z = dahl.next(*z, dq);
                *z
            }
        }
    }

    pub(super) fn remembers(&self) -> bool {
        matches!(self, FrictionShape::Dahl(_))
    }

    pub(super) fn label(&self) -> String {
        match self {
            FrictionShape::Sliding(s) => s.label(),
            FrictionShape::Dahl(d) => format!("dahl({:.3e})", d.stiffness),
        }
    }

    pub(super) fn unit(&self) -> &'static str {
        match self {
            FrictionShape::Sliding(s) => s.unit(),
            FrictionShape::Dahl(_) => "N·m",
        }
    }
}
