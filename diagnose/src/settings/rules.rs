//! Special rules, each of which can be switched off alone to see what it is for.

use super::Settings;
use super::fields::Scaled;

/// A rule beyond the criterion itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Another least gain for friction with memory, for friction by load and for what parameters can absorb.
    GainByEffect,
    /// Another least part of the error for narrow memory, abrupt Stribeck friction, delays and springs.
    PartByEffect,
    /// A delay's part of the error is the middle joint's where that is more.
    MiddleJoint,
    /// What makes a prediction late or oscillate needs no part of the error where its gain is large.
    LargeGain,
    /// A cause has to exceed a part of what earlier ones gained.
    Leftovers,
    /// A trace names a play by itself, whatever its torque explains.
    Trace,
    /// Nats for what a trace or another sensor says.
    Evidence,
    /// A body on the last link is charged for two coefficients, and for every joint against wider tolerances.
    LastLink,
    /// Priors of a suspected link and of a payload.
    LinkPriors,
    /// Fewer coefficients are tried in the place of a link's full set.
    FullLink,
    /// What a free refit beats is barred, and the search runs again.
    Barred,
    /// Causes that halve the error of a short recording.
    Short,
    /// A joint that needs links and friction is listed by what helps more, and a link that was found wrong is listed.
    Listed,
    /// What bursts have to be beside loud to be pushes.
    Pushes,
    /// Where there are pushes, structure is looked for without the loudest quarter as well.
    BesidePushes,
}

impl Rule {
    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::GainByEffect,
        Self::PartByEffect,
        Self::MiddleJoint,
        Self::LargeGain,
        Self::Leftovers,
        Self::Trace,
        Self::Evidence,
        Self::LastLink,
        Self::LinkPriors,
        Self::FullLink,
        Self::Barred,
        Self::Short,
        Self::Listed,
        Self::Pushes,
        Self::BesidePushes,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::GainByEffect => "gain-by-effect",
            Self::PartByEffect => "part-by-effect",
            Self::MiddleJoint => "middle-joint",
            Self::LargeGain => "large-gain",
            Self::Leftovers => "leftovers",
            Self::Trace => "trace",
            Self::Evidence => "evidence",
            Self::LastLink => "last-link",
            Self::LinkPriors => "link-priors",
            Self::FullLink => "full-link",
            Self::Barred => "barred",
            Self::Short => "short",
            Self::Listed => "listed",
            Self::Pushes => "pushes",
            Self::BesidePushes => "beside-pushes",
        }
    }

    /// The rule of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|rule| rule.name() == name)
    }
}

/// Rules that are switched off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Off(u16);

impl Off {
    /// None is.
    pub const NONE: Self = Self(0);

    /// Whether a rule is.
    pub fn holds(self, rule: Rule) -> bool {
        self.0 & (1 << rule as u16) != 0
    }
}

impl Scaled for Off {
    fn scale(&mut self, _: f64) {}
}

impl Settings {
    /// The same with one rule switched off: one that is made of numbers alone by numbers that ask for nothing.
    pub fn without(&self, rule: Rule) -> Self {
        let mut own = self.clone();
        own.search.off.0 |= 1 << rule as u16;
        match rule {
            Rule::LargeGain => own.search.enough_dynamic = f64::INFINITY,
            Rule::Leftovers => {
                own.search.leftover = 0.0;
                own.search.leftover_same = 0.0;
            }
            Rule::Pushes => {
                let contact = &mut own.traces.contact;
                contact.fewest = 1;
                contact.fewest_windows = 1;
                contact.least_height = 0.0;
                contact.longest = f64::INFINITY;
                contact.again = f64::INFINITY;
                contact.most_time = 1.0;
                contact.least_share = 0.0;
                contact.alone = f64::INFINITY;
                contact.several = 0.0;
                contact.crossing = f64::INFINITY;
                contact.cut_off = f64::INFINITY;
                contact.steady = 0.0;
            }
            _ => {}
        }
        own
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rule_has_a_name_of_its_own_and_is_off_alone() {
        for (i, rule) in Rule::ALL.into_iter().enumerate() {
            assert_eq!(Rule::named(rule.name()), Some(rule));
            let settings = Settings::default().without(rule);
            for (k, other) in Rule::ALL.into_iter().enumerate() {
                assert_eq!(settings.search.off.holds(other), i == k);
            }
        }
        assert_eq!(Rule::named("everything"), None);
        assert_eq!(Settings::default().search.off, Off::NONE);
    }
}
