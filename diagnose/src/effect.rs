//! Names of the effects, as the report spells them.

use serde::{Serialize, Serializer};

/// An effect of the catalogue. `CONTRACT` order: parameters first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Effect {
    /// Mass, centre of mass or inertia of a link differ from the model's.
    LinkParameters,
    /// Viscous or Coulomb coefficients differ from the model's.
    FrictionParameters,
    /// A body fixed to the last link.
    Payload,
    /// Reflected inertia of motor and gear on its own joint.
    RotorInertia,
    /// Gravity's direction in the base frame.
    BaseTilt,
    /// A spring, gas or hydraulic torque of the joint's own position.
    Counterbalance,
    /// Friction that differs by direction.
    AsymmetricFriction,
    /// Higher friction near zero velocity that falls as the joint starts to slide.
    StribeckFriction,
    /// Friction that grows less or more than linearly with velocity.
    NonlinearViscousFriction,
    /// Friction that grows with the transmitted torque.
    LoadDependentFriction,
    /// Friction scaled periodically by the joint's position.
    PositionDependentFriction,
    /// Friction with memory around reversals.
    PreslidingHysteresis,
    /// Friction that changes over the recording.
    FrictionDrift,
    /// Torque periodic in position.
    TorqueRipple,
    /// A compliant transmission.
    JointElasticity,
    /// Play in the transmission.
    Backlash,
    /// Another joint's motion driving this joint's transmission.
    JointCoupling,
    /// A wrong torque constant or gear ratio.
    TorqueGain,
    /// A constant bias of the torque measurement.
    TorqueOffset,
    /// Torque and motion recorded with a shift in time.
    TimeDelay,
    /// The recorded torque is cut at a limit.
    Saturation,
    /// A wrong joint zero.
    EncoderOffset,
    /// A force from outside during part of the recording.
    ExternalContact,
}

impl Effect {
    /// All of them.
    pub const ALL: [Effect; 23] = [
        Effect::LinkParameters,
        Effect::FrictionParameters,
        Effect::Payload,
        Effect::RotorInertia,
        Effect::BaseTilt,
        Effect::Counterbalance,
        Effect::AsymmetricFriction,
        Effect::StribeckFriction,
        Effect::NonlinearViscousFriction,
        Effect::LoadDependentFriction,
        Effect::PositionDependentFriction,
        Effect::PreslidingHysteresis,
        Effect::FrictionDrift,
        Effect::TorqueRipple,
        Effect::JointElasticity,
        Effect::Backlash,
        Effect::JointCoupling,
        Effect::TorqueGain,
        Effect::TorqueOffset,
        Effect::TimeDelay,
        Effect::Saturation,
        Effect::EncoderOffset,
        Effect::ExternalContact,
    ];

    /// Name in the report.
    pub fn name(self) -> &'static str {
        match self {
            Effect::LinkParameters => "link_parameters",
            Effect::FrictionParameters => "friction_parameters",
            Effect::Payload => "payload",
            Effect::RotorInertia => "rotor_inertia",
            Effect::BaseTilt => "base_tilt",
            Effect::Counterbalance => "counterbalance",
            Effect::AsymmetricFriction => "asymmetric_friction",
            Effect::StribeckFriction => "stribeck_friction",
            Effect::NonlinearViscousFriction => "nonlinear_viscous_friction",
            Effect::LoadDependentFriction => "load_dependent_friction",
            Effect::PositionDependentFriction => "position_dependent_friction",
            Effect::PreslidingHysteresis => "presliding_hysteresis",
            Effect::FrictionDrift => "friction_drift",
            Effect::TorqueRipple => "torque_ripple",
            Effect::JointElasticity => "joint_elasticity",
            Effect::Backlash => "backlash",
            Effect::JointCoupling => "joint_coupling",
            Effect::TorqueGain => "torque_gain",
            Effect::TorqueOffset => "torque_offset",
            Effect::TimeDelay => "time_delay",
            Effect::Saturation => "saturation",
            Effect::EncoderOffset => "encoder_offset",
            Effect::ExternalContact => "external_contact",
        }
    }

    /// Whether it is a change of parameters that the model's structure has already.
    pub fn is_parameter(self) -> bool {
        matches!(self, Effect::LinkParameters | Effect::FrictionParameters)
    }

    /// Whether it makes the whole prediction late or oscillate, of which other effects give some as well.
    pub fn is_dynamic(self) -> bool {
        matches!(self, Effect::TimeDelay | Effect::JointElasticity)
    }

    /// Whether free inertial and friction parameters can take most of it over, so that its worth
    /// counts from the model as given.
    pub fn is_absorbable(self) -> bool {
        self.is_parameter()
            || matches!(
                self,
                Effect::Payload
                    | Effect::RotorInertia
                    | Effect::BaseTilt
                    | Effect::Counterbalance
                    | Effect::TorqueGain
                    | Effect::EncoderOffset
            )
    }
}

impl Serialize for Effect {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}
