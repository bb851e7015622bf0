//! Choice of the effects that are searched.

use super::candidate::{Bound, Candidate};
use super::effect::Effect;

/// Choice of the effects that are searched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// All effects of the catalogue.
    #[default]
    All,
    /// All effects but one, for the proof.
    Without(Effect),
    /// One effect beside changes of parameters, for the proof.
    Only(Effect),
    /// Effects that may change between two days of one robot: load, which may also be removed, friction, torque
    /// channel, mount, joint zeros and pushes.
    Changes,
}

impl Choice {
    /// Whether an effect is searched.
    pub fn holds(self, effect: Effect) -> bool {
        match self {
            Self::All => true,
            Self::Without(other) => effect != other,
            Self::Only(other) => effect == other || effect.info().parameter,
            Self::Changes => matches!(
                effect,
                Effect::Payload
                    | Effect::FrictionParameters
                    | Effect::TorqueGain
                    | Effect::TorqueOffset
                    | Effect::TimeDelay
                    | Effect::BaseTilt
                    | Effect::EncoderOffset
                    | Effect::ExternalContact
            ),
        }
    }

    /// Keeps the candidates of searched effects.
    pub fn retain(self, candidates: &mut Vec<Candidate>) {
        candidates.retain(|c| self.holds(c.effect));
        if self == Self::Changes {
            let loads = candidates
                .iter_mut()
                .filter(|c| c.effect == Effect::Payload);
            loads.for_each(|c| c.bounds[0] = Bound::Free);
        }
    }
}
