//! Friction that grows with the torque that the transmission carries.

use super::{FrictionShape, Sliding};
use serde::{Deserialize, Serialize};

/// Friction shape times |load|^exponent, load being the joint's rigid-body torque in N·m.
///
/// Bittencourt and Gunnarsson (2012), equation 6: Coulomb friction linear in |load|.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadFriction {
    /// Friction shape that is multiplied by |load|^exponent.
    pub friction: FrictionShape,
    /// Exponent of |load|; one is linear.
    #[serde(default = "linear", skip_serializing_if = "is_linear")]
    pub exponent: f64,
}

fn linear() -> f64 {
    1.0
}

fn is_linear(exponent: &f64) -> bool {
    *exponent == 1.0
}

impl LoadFriction {
    /// Load friction that is linear in the load, with this friction shape.
    pub fn linear(friction: FrictionShape) -> Self {
        Self {
            friction,
            exponent: 1.0,
        }
    }

    /// Factor on the friction at a load in N·m.
    pub fn factor(&self, load: f64) -> f64 {
        if self.exponent == 1.0 {
            load.abs()
        } else {
            load.abs().powf(self.exponent)
        }
    }

    pub(super) fn label(&self) -> String {
        if self.exponent == 1.0 {
            format!("load*{}", self.friction.label())
        } else {
            format!("load^{}*{}", self.exponent, self.friction.label())
        }
    }

    pub(super) fn unit(&self) -> &'static str {
        if self.exponent != 1.0 {
            return "(N·m)^(1−p)";
        }
        match self.friction {
            FrictionShape::Sliding(Sliding::Viscous | Sliding::AsymmetricViscous) => "s/rad",
            _ => "1",
        }
    }
}
