//! Special rules of the search, each of which an ablation can switch off alone.

use super::Settings;
use super::fields::Scaled;

/// A rule beyond the criterion itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Another least gain for friction with memory, friction by load and effects that parameters can absorb.
    GainByEffect,
    /// Another least part of the error for narrow memory, abrupt Stribeck friction, delays and springs.
    PartByEffect,
    /// The part of the error that a delay removes is that on the median joint, where that is more.
    MiddleJoint,
    /// Effects that make a prediction late or oscillate need no part of the error where their gain is large.
    LargeGain,
    /// A cause must exceed a part of the gain of earlier ones.
    Leftovers,
    /// A trace names a play by itself, whatever its torque explains.
    Trace,
    /// Candidates get additional nats for a trace in the residual or another sensor.
    Evidence,
    /// A body on the last link is charged for two coefficients, and for every joint against wider tolerances.
    LastLink,
    /// Priors of a suspected link and of a payload.
    LinkPriors,
    /// Fewer coefficients are tried in the place of a link's full set.
    FullLink,
    /// A cause whose error a free refit undercuts is barred, and the search runs again.
    Barred,
    /// Causes that halve the error of a short recording are accepted.
    Short,
    /// A joint that needs links and friction is listed by the one that helps more; a link found wrong by itself is listed.
    Listed,
    /// Conditions on pushes beside their height.
    Pushes,
    /// Where there are pushes, structure is looked for without the loudest quarter as well.
    BesidePushes,
}

impl Rule {
    /// All rules.
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
    /// No rule switched off.
    pub const NONE: Self = Self(0);

    /// Whether the rule is switched off.
    pub fn holds(self, rule: Rule) -> bool {
        self.0 & (1 << rule as u16) != 0
    }
}

impl Scaled for Off {
    fn scale(&mut self, _: f64) {}
}

impl Settings {
    /// Settings with one rule switched off. A rule that consists of numbers alone gets numbers that exclude nothing.
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
