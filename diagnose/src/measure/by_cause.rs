//! The ladder in the order of the words: the causes first, largest first, and the model's other parameters last.
//!
//! Parameters that are fitted freely before any cause is named take a cause's place: those of the last links are a
//! payload's. `ladder` has that order, because other tools compare it. Here every cause keeps what it closes.

use crate::catalogue::effect::Effect;
use crate::ladder::rungs::Free;
use crate::schema::{Cause, Step};

/// What a cause adds to a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Added {
    /// An effect that the model lacks, by its index among the accepted causes.
    Structure(usize),
    /// Inertial parameters of links, free from here on.
    Links,
    /// Friction coefficients, free from here on.
    Friction,
    /// Pushes, whose samples no longer count from here on.
    Pushes,
}

impl Added {
    /// What a cause of this effect adds; `accepted` is its index where it is an effect that the model lacks.
    pub fn by(effect: Effect, accepted: Option<usize>) -> Self {
        match accepted {
            Some(cause) => Self::Structure(cause),
            None if effect.info().outside => Self::Pushes,
            None if effect.info().friction => Self::Friction,
            None => Self::Links,
        }
    }
}

/// The model with all of these: effects by index, free parameters, and whether pushed samples are left out.
pub fn together(added: &[Added]) -> (Vec<usize>, Free, bool) {
    let has = |one: Added| added.contains(&one);
    let free = match (has(Added::Links), has(Added::Friction)) {
        (true, true) => Free::All,
        (true, false) => Free::Links,
        (false, true) => Free::Friction,
        (false, false) => Free::Nothing,
    };
    let effects = added.iter().filter_map(|a| match a {
        Added::Structure(cause) => Some(*cause),
        _ => None,
    });
    let mut effects: Vec<usize> = effects.collect();
    effects.sort_unstable();
    (effects, free, has(Added::Pushes))
}

/// Steps: as given, then one per cause in the order of `causes`, each with all causes before it and the other parameters
/// as given; at last `reidentified`, where the other parameters are fitted, too. The first and the last are those of `ladder`.
/// `step` scores the model with what is added.
pub fn by_cause(
    ladder: &[Step],
    causes: &[(Cause, Added)],
    step: impl Fn(&str, &[Added]) -> Step,
) -> Vec<Step> {
    let added: Vec<Added> = causes.iter().map(|(_, added)| *added).collect();
    let mut steps: Vec<Step> = ladder.first().cloned().into_iter().collect();
    for (n, (cause, _)) in causes.iter().enumerate() {
        steps.push(step(cause.effect.name(), &added[..=n]));
    }
    if together(&added).1 != Free::All {
        steps.extend(ladder.last().map(|last| Step {
            step: "reidentified".to_owned(),
            ..last.clone()
        }));
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_free_where_a_cause_frees_them_and_pushes_cut_samples_out() {
        let payload = Added::by(Effect::Payload, Some(1));
        assert_eq!(together(&[payload]), (vec![1], Free::Nothing, false));
        let rubs = Added::by(Effect::FrictionParameters, None);
        let earlier = Added::by(Effect::TorqueRipple, Some(0));
        let all = [payload, rubs, earlier];
        assert_eq!(together(&all), (vec![0, 1], Free::Friction, false));
        let links = Added::by(Effect::LinkParameters, None);
        let pushed = Added::by(Effect::ExternalContact, None);
        assert_eq!(together(&[links, rubs, pushed]), (vec![], Free::All, true));
    }
}
