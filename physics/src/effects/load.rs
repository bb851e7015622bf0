//! Friction that grows with the torque that the transmission carries.

use super::{FrictionShape, Sliding};
use serde::{Deserialize, Serialize};

/// |load| times a friction shape, load being the joint's rigid-body torque in N·m.
///
/// Bittencourt and Gunnarsson (2012), equation 6: Coulomb friction linear in |load|.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadFriction {
    /// What |load| multiplies.
    pub friction: FrictionShape,
}

impl LoadFriction {
    pub(super) fn unit(&self) -> &'static str {
        match self.friction {
            FrictionShape::Sliding(Sliding::Viscous | Sliding::AsymmetricViscous) => "s/rad",
            _ => "1",
        }
    }
}
