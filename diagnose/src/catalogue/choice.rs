//! Which effects are looked for.

use super::candidate::{Bound, Candidate};
use super::effect::Effect;

/// Which effects are looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// All of the catalogue.
    #[default]
    All,
    /// All but one, for the proof.
    Without(Effect),
    /// What may differ between two days of one robot: its load, which may also be gone, friction, torque channel, mount and
    /// joint zeros, and pushes.
    Changes,
}

impl Choice {
    /// Whether an effect is looked for.
    pub fn holds(self, effect: Effect) -> bool {
        match self {
            Self::All => true,
            Self::Without(other) => effect != other,
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

    /// Leaves the candidates that are looked for.
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
