//! Effects of the catalogue.

/// An effect of the catalogue, parameters first. The description of each is in its own file, as [`super::info::Info`].
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
    /// Wrong direction of gravity in the base frame.
    BaseTilt,
    /// A spring, gas or hydraulic torque that depends on the joint's own position.
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
    /// Coupling: another joint's motion drives this joint's transmission.
    JointCoupling,
    /// A wrong torque constant or gear ratio.
    TorqueGain,
    /// A constant bias of the torque measurement.
    TorqueOffset,
    /// Torque and motion recorded with a shift in time.
    TimeDelay,
    /// The recorded torque is cut at a limit.
    Saturation,
    /// Wrong joint zero: recorded positions are off by a constant.
    EncoderOffset,
    /// A force from outside during part of the recording.
    ExternalContact,
}

impl Effect {
    /// All effects of the catalogue, parameters first.
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
}
