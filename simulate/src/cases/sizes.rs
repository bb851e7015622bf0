//! Sizes of the effects, and how their torque is told from the rest.

use super::withheld::Withheld;

impl Withheld {
    /// Largest size that is still plausible.
    pub fn largest(&self) -> f64 {
        match self {
            Self::Link { .. } => 0.5,
            Self::Friction { .. } => 0.9,
            Self::Tilt { .. } => 0.15,
            Self::Mesh { .. } => 0.45,
            Self::Bristle { .. } => 0.12,
            Self::Warm { .. } => 3.0,
            Self::Gain { .. } => 0.3,
            Self::Delay { .. } => 0.03,
            Self::Saturation { .. } => 0.6,
            Self::Zero { .. } => 0.12,
            Self::Play { .. } => 0.02,
            Self::Dropouts { .. } => 0.8,
            _ => f64::INFINITY,
        }
    }

    /// Whether it acts through the plant's own vibration: then its torque is noted below 20 Hz only, as above that it
    /// is the difference of two large torques.
    pub fn vibrates(&self) -> bool {
        matches!(
            self,
            Self::Elastic { .. } | Self::Play { .. } | Self::Mount { .. }
        )
    }

    /// A small size to start the search from.
    pub fn smallest(&self) -> f64 {
        match self {
            Self::Gas { .. } => 100.0,
            Self::Coil { .. } => 1000.0,
            Self::Delay { .. } => 0.003,
            Self::Saturation { .. } => 0.15,
            Self::Elastic { .. } | Self::Mount { .. } => 1e-6,
            Self::Play { .. } | Self::Bristle { .. } => 0.002,
            Self::Tilt { .. } | Self::Zero { .. } => 0.02,
            Self::Contact { .. } => 1.0,
            _ => 0.1,
        }
    }

    /// Whether its torque is that of one mechanism alone, which the simulation notes by itself.
    pub fn is_self_contained(&self) -> bool {
        matches!(
            self,
            Self::Asymmetric { .. }
                | Self::Stribeck { .. }
                | Self::Drag { .. }
                | Self::Mesh { .. }
                | Self::Runout { .. }
                | Self::Warm { .. }
                | Self::Ripple { .. }
                | Self::Coupling { .. }
                | Self::Gas { .. }
                | Self::Coil { .. }
                | Self::Contact { .. }
        )
    }
}
