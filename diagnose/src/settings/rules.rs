//! Special rules of the search, each of which an ablation can switch off alone.

use super::Settings;
use super::fields::Scaled;
use std::sync::Arc;
use std::sync::atomic::{AtomicU16, Ordering};

/// A rule beyond the criterion itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Least gain that differs for friction with memory, friction by load and effects that parameters can absorb.
    GainByEffect,
    /// Least part of the error that differs for narrow memory, abrupt Stribeck friction, delays and springs.
    PartByEffect,
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
    /// Search for structure without the loudest quarter as well, where there are pushes.
    BesidePushes,
}

impl Rule {
    /// All rules of the search.
    pub const ALL: [Self; 13] = [
        Self::GainByEffect,
        Self::PartByEffect,
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

    fn bit(self) -> u16 {
        1 << self as u16
    }

    /// Whether the rule changes prices, priors or a trace's limits, rather than one decision.
    fn is_continuous(self) -> bool {
        matches!(
            self,
            Self::Leftovers | Self::LastLink | Self::LinkPriors | Self::Pushes
        )
    }

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::GainByEffect => "gain-by-effect",
            Self::PartByEffect => "part-by-effect",
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

    /// Rule with the name `name`.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|rule| rule.name() == name)
    }
}

/// Rules that are switched off, and those that decided something. Clones share the record of what decided.
#[derive(Clone, Debug, Default)]
pub struct Off {
    off: u16,
    decided: Arc<AtomicU16>,
}

impl Off {
    /// Whether the rule is switched off.
    pub fn holds(&self, rule: Rule) -> bool {
        self.off & rule.bit() != 0
    }

    /// Whether the rule applies where the answer without it would `differ`; that it decided is recorded.
    pub fn applies(&self, rule: Rule, differ: bool) -> bool {
        let applies = differ && !self.holds(rule);
        if applies {
            self.decided.fetch_or(rule.bit(), Ordering::Relaxed);
        }
        applies
    }

    /// Whether the rule decided anything so far. Rules that change prices or priors count as if they always did.
    pub fn decided(&self, rule: Rule) -> bool {
        rule.is_continuous() || self.decided.load(Ordering::Relaxed) & rule.bit() != 0
    }
}

impl Scaled for Off {
    fn scale(&mut self, _: f64) {}
}

impl Settings {
    /// The same settings with an empty record of the rules that decided.
    pub fn afresh(&self) -> Self {
        let mut own = self.clone();
        own.search.off.decided = Arc::default();
        own
    }

    /// Settings with one rule switched off. A rule that consists of numbers alone gets numbers that exclude nothing.
    pub fn without(&self, rule: Rule) -> Self {
        let mut own = self.afresh();
        own.search.off.off |= rule.bit();
        match rule {
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
    }

    #[test]
    fn a_rule_that_is_off_decides_nothing_and_one_that_would_change_nothing_neither() {
        let off = Settings::default().without(Rule::Trace).search.off;
        assert!(!off.applies(Rule::Trace, true) && !off.decided(Rule::Trace));
        assert!(!off.applies(Rule::Short, false) && !off.decided(Rule::Short));
        let other = off.clone();
        assert!(other.applies(Rule::Short, true) && off.decided(Rule::Short));
        assert!(off.decided(Rule::Leftovers));
    }
}
