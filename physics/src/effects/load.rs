//! Friction that grows with the torque that the transmission carries.

use super::{Dahl, Sliding};
use serde::{Deserialize, Serialize};

/// |load| times a friction shape, load being the joint's rigid-body torque in N·m.
///
/// Bittencourt and Gunnarsson (2012), equation 6: Coulomb friction linear in |load|.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadFriction {
    /// What |load| multiplies.
    pub friction: LoadShape,
}

/// The friction that a load scales.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LoadShape {
    /// Friction of the present velocity.
    Sliding(Sliding),
    /// Friction with memory of displacement.
    Dahl(Dahl),
}

impl LoadShape {
    pub(super) fn label(&self) -> String {
        match self {
            LoadShape::Sliding(s) => s.label(),
            LoadShape::Dahl(d) => format!("dahl({:.3e})", d.stiffness),
        }
    }
}

impl LoadFriction {
    pub(super) fn unit(&self) -> &'static str {
        match self.friction {
            LoadShape::Sliding(Sliding::Viscous | Sliding::AsymmetricViscous) => "s/rad",
            _ => "1",
        }
    }
}
