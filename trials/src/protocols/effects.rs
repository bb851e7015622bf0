//! Effects of a protocol robot's joint beyond viscous and Coulomb friction.

use serde::Serialize;

/// Effects of a joint beyond viscous and Coulomb friction. Zero switches an effect off.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct JointEffects {
    /// Ripple: amplitude of the first wave, N·m; a second has 40 % of it at 2.7 times the order.
    pub ripple: f64,
    /// Order of the first wave, rad⁻¹.
    pub order: f64,
    /// Extra friction of a starting joint, N·m (Lorentz).
    pub stribeck: f64,
    /// Speed at which half of that extra friction has gone, rad/s.
    pub stribeck_speed: f64,
    /// Drag of activated flow at 3 rad/s, N·m.
    pub flow: f64,
    /// Share of the transmitted torque that is lost to friction.
    pub loss: f64,
    /// Deflection of the bristles that carry the Coulomb friction, rad.
    pub deflection: f64,
    /// Ratio of the cold gear's extra friction to the warm gear's friction.
    pub cold: f64,
}

/// Kind of a joint's effect among [`JointEffects`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Effect {
    /// Torque periodic in the position.
    Ripple,
    /// Extra friction of a starting joint.
    Stribeck,
    /// Drag of a fluid by thermally activated flow (Eyring): it grows as asinh of the speed.
    Flow,
    /// Friction that grows with the load.
    Loss,
    /// Coulomb friction that bends before it slides.
    Presliding,
    /// Friction that falls with temperature.
    Temperature,
}

impl Effect {
    /// All effects of a protocol's joint.
    pub const ALL: [Self; 6] = [
        Self::Ripple,
        Self::Stribeck,
        Self::Flow,
        Self::Loss,
        Self::Presliding,
        Self::Temperature,
    ];

    /// Name of the effect in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ripple => "ripple",
            Self::Stribeck => "Stribeck friction",
            Self::Flow => "activated flow",
            Self::Loss => "friction by load",
            Self::Presliding => "presliding",
            Self::Temperature => "temperature",
        }
    }
}

impl JointEffects {
    /// The joint's effects without one of them.
    pub fn without(self, effect: Effect) -> Self {
        let mut left = self;
        match effect {
            Effect::Ripple => left.ripple = 0.0,
            Effect::Stribeck => left.stribeck = 0.0,
            Effect::Flow => left.flow = 0.0,
            Effect::Loss => left.loss = 0.0,
            Effect::Presliding => left.deflection = 0.0,
            Effect::Temperature => left.cold = 0.0,
        }
        left
    }
}
