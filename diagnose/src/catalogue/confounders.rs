//! What an effect can be mistaken for on honest grounds: names that are a fair second answer where the effect's own
//! candidate is not in the catalogue. From the signatures of the catalogue's files.

use crate::effect::Effect;

impl Effect {
    /// Effects whose torque looks like this one's on a usual recording. Parameters of links and of friction are
    /// confounders of whatever they can absorb.
    pub fn confounders(self) -> &'static [Effect] {
        use Effect::{
            AsymmetricFriction, Backlash, BaseTilt, Counterbalance, EncoderOffset, FrictionDrift,
            FrictionParameters, JointCoupling, JointElasticity, LinkParameters,
            LoadDependentFriction, NonlinearViscousFriction, Payload, PositionDependentFriction,
            PreslidingHysteresis, RotorInertia, StribeckFriction, TimeDelay, TorqueGain,
            TorqueOffset, TorqueRipple,
        };
        match self {
            LinkParameters => &[Payload, RotorInertia, TorqueGain],
            FrictionParameters => &[NonlinearViscousFriction, StribeckFriction],
            Payload => &[LinkParameters],
            RotorInertia => &[LinkParameters, TorqueGain, JointElasticity],
            BaseTilt => &[LinkParameters, EncoderOffset, Counterbalance, TorqueOffset],
            Counterbalance => &[LinkParameters, EncoderOffset, BaseTilt, TorqueRipple],
            AsymmetricFriction => &[TorqueOffset, FrictionParameters],
            StribeckFriction => &[
                FrictionParameters,
                NonlinearViscousFriction,
                PreslidingHysteresis,
            ],
            NonlinearViscousFriction => &[FrictionParameters, StribeckFriction],
            LoadDependentFriction => &[
                FrictionParameters,
                TorqueGain,
                StribeckFriction,
                PositionDependentFriction,
            ],
            PositionDependentFriction => &[FrictionParameters, LoadDependentFriction, TorqueRipple],
            PreslidingHysteresis => &[
                FrictionParameters,
                StribeckFriction,
                Backlash,
                JointElasticity,
            ],
            FrictionDrift => &[FrictionParameters, NonlinearViscousFriction],
            TorqueRipple => &[Counterbalance, EncoderOffset],
            JointElasticity => &[Backlash, TimeDelay, RotorInertia],
            Backlash => &[JointElasticity, PreslidingHysteresis, TimeDelay],
            JointCoupling => &[FrictionParameters, LinkParameters],
            TorqueGain => &[
                LinkParameters,
                FrictionParameters,
                Payload,
                LoadDependentFriction,
            ],
            TorqueOffset => &[AsymmetricFriction, Counterbalance],
            TimeDelay => &[JointElasticity, Backlash],
            Effect::Saturation => &[TorqueGain, NonlinearViscousFriction],
            EncoderOffset => &[LinkParameters, BaseTilt, Counterbalance, TorqueOffset],
            Effect::ExternalContact => &[],
        }
    }
}
