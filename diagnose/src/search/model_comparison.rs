//! One number against many: whether few parameters, together with changes of the given ones inside their tolerance,
//! explain what a free refit of all of them explains.
//!
//! Both are compared on trajectories left out, by squared error on the joints whose torque the cause changes. What leaves
//! more than `rivalled` times the refit's stands in for a model that is wrong elsewhere: it is barred and the search
//! runs again, the tolerances widened where nothing else brings the error down.
//!
//! How far the given parameters may be off nobody knows beforehand: of several factors on their tolerances, each with the causes that
//! are found under it, the recording chooses the one under which it is likeliest.

use crate::algebra::fit::{Fit, Variable};
use crate::catalogue::Candidate;
use crate::catalogue::effect::Effect;
use crate::search::objective::{Freedom, Objective};
use crate::search::select::{CandidateScore, Search, Selection, without};
use crate::settings::Rule;
use crate::simulator::NominalModel;
use physics::robot::PARAMETERS_PER_LINK;
use std::collections::HashSet;
use std::sync::OnceLock;

/// Searches with one more cause barred, at most, at each width.
const ROUNDS: usize = 6;

/// What the search came to, and how it stands against the free refit.
pub struct Answer<'a> {
    /// The causes.
    pub selection: Selection<'a>,
    /// For each cause everything tried in its place, the others standing, best first.
    pub steps: Vec<Vec<CandidateScore>>,
    /// What was tried beside all of them, best first.
    pub rest: Vec<CandidateScore>,
    /// Base variables with the priors of the answer.
    pub base: Vec<Variable>,
    /// How each accepted cause stands against the parameters.
    pub against: Vec<Comparison>,
}

/// How a cause stands against the parameters; nothing is said of what they cannot take over, and of parameters.
#[derive(Clone, Copy, Debug, Default)]
pub struct Comparison {
    /// Squared error over that of the free refit in its place.
    pub over_refit: Option<f64>,
    /// Factor on the tolerances of the given parameters up to which it is found; None where it is found under any.
    pub within: Option<f64>,
}

/// The comparison over one catalogue.
pub struct Simplest<'a> {
    /// The criterion.
    pub objective: &'a Objective<'a>,
    /// The catalogue.
    pub candidates: &'a [Candidate],
    /// Columns of each candidate.
    pub members: &'a [Vec<usize>],
    /// The model as given.
    pub model: &'a NominalModel,
    /// Gain that chance reaches on this recording, nats.
    pub chance: f64,
}

/// A search that has run.
struct Run<'a> {
    search: Search<'a>,
    selection: Selection<'a>,
    over_refit: Vec<Option<f64>>,
    /// Squared error over the free refit's from which a cause is beaten.
    rivalled: f64,
    /// No joint is left that a free refit brings down by far.
    enough: bool,
}

impl<'a> Simplest<'a> {
    /// The simplest causes that stand.
    pub fn answer(&self) -> Answer<'a> {
        let settings = self.objective.settings;
        // A recording of few joints says little of the tolerance: then the stated one stands.
        let runs = settings.tolerant.map(|links| {
            let friction = self.friction(links);
            let run = self.fewer(Freedom { links, friction });
            let widened = links.log2() + friction.log2();
            let surprise = run.surprise() + settings.widening * widened;
            (links, surprise, run)
        });
        let found: Vec<(f64, Vec<usize>)> = runs
            .iter()
            .map(|(links, _, run)| (*links, run.selection.accepted.clone()))
            .collect();
        let any = settings.off.holds(Rule::Barred);
        let standing = runs.into_iter().filter(|(_, _, run)| any || run.stands());
        let likeliest = standing.min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((_, _, run)) = likeliest {
            let within = |cause: usize| self.within(&found, cause);
            return run.answer(within);
        }
        let mut last = None;
        for freedom in settings.wider {
            let mut barred = HashSet::new();
            for _ in 0..ROUNDS {
                let tried = self.run(freedom.into(), barred.clone());
                if tried.stands() {
                    return tried.answer(|_| None);
                }
                // Where no single one is beaten, all of them leave too much together.
                let mut instead = tried.beaten();
                if instead.is_empty() {
                    instead = tried.single();
                }
                barred.extend(self.alike(&instead));
                last = Some(tried);
                if instead.is_empty() {
                    break;
                }
            }
        }
        last.unwrap_or_else(|| self.run(1.0.into(), HashSet::new()))
            .answer(|_| None)
    }

    /// The widest tolerance under which something like a cause is found, where that is not the widest of all.
    fn within(&self, found: &[(f64, Vec<usize>)], cause: usize) -> Option<f64> {
        let alike = self.alike(&[cause]);
        let has = |accepted: &[usize]| accepted.iter().any(|c| alike.contains(c));
        let widest = found.iter().rposition(|(_, accepted)| has(accepted))?;
        (widest + 1 < found.len()).then(|| found[widest].0)
    }

    /// Factor on the tolerances of friction under which the recording is likeliest without any cause, the links' given: one
    /// factor on both lets friction that is right keep the links' tolerance down, and the last link's error look like a payload.
    fn friction(&self, links: f64) -> f64 {
        let settings = self.objective.settings;
        let surprise = |friction: f64| {
            let base = self.objective.base(self.model, Freedom { links, friction });
            let fit = self.objective.fit(base);
            self.objective.of_fit(&fit, 0) + fit.width() + settings.widening * friction.log2()
        };
        let each = settings.tolerant.map(|f| (f, surprise(f)));
        let likeliest = each.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
        likeliest.map_or(links, |(friction, _)| friction)
    }

    /// The search without a link's full set of parameters, where it needs fewer coefficients than the search with them and
    /// stands against the refit; else the search with them.
    fn fewer(&self, freedom: Freedom) -> Run<'a> {
        let full = self.run(freedom, HashSet::new());
        let many = |c: usize| self.is_many(c);
        let off = full.search.off(Rule::FullLink);
        if off || !full.selection.accepted.iter().any(|&c| many(c)) {
            return full;
        }
        let barred = (0..self.candidates.len()).filter(|&c| many(c)).collect();
        let few = self.run(freedom, barred);
        let price = |t: &Run| -> usize {
            let of = t.selection.accepted.iter();
            of.map(|&c| self.members[c].len()).sum()
        };
        let new = |c: &usize| {
            let effect = self.candidates[*c].effect;
            effect.info().absorbable && !full.selection.accepted.contains(c)
        };
        let named = few.selection.accepted.iter().any(new);
        let rivalled = self.objective.settings.rivalled;
        let low = || {
            let [few, full] = [&few, &full].map(|t| self.relative(&t.selection.fit));
            few.iter()
                .zip(&full)
                .all(|(few, full)| few <= &(rivalled * full))
        };
        if named && few.stands() && price(&few) < price(&full) && low() {
            few
        } else {
            full
        }
    }

    /// Whether a candidate is a link's full set of parameters.
    fn is_many(&self, candidate: usize) -> bool {
        self.candidates[candidate].effect == Effect::LinkParameters
            && self.members[candidate].len() == PARAMETERS_PER_LINK
    }

    /// Candidates with the effect and the joints of some.
    fn alike(&self, some: &[usize]) -> Vec<usize> {
        let same = |c: &usize| {
            some.iter().any(|&s| {
                let (a, b) = (&self.candidates[s], &self.candidates[*c]);
                a.effect == b.effect && a.joints == b.joints
            })
        };
        (0..self.candidates.len()).filter(same).collect()
    }

    /// A search beside some base, some candidates aside.
    pub(super) fn search(&self, base: Vec<Variable>, barred: HashSet<usize>) -> Search<'a> {
        Search {
            objective: self.objective,
            candidates: self.candidates,
            members: self.members,
            robot: self.model.sizes(),
            base,
            barred,
            chance: self.chance,
            missing: OnceLock::new(),
        }
    }

    fn run(&self, freedom: Freedom, barred: HashSet<usize>) -> Run<'a> {
        let search = self.search(self.objective.base(self.model, freedom), barred);
        let selection = search.run();
        let accepted = &selection.accepted;
        let own = self.relative(&selection.fit);
        let over_refit = (0..accepted.len())
            .map(|i| self.over_refit(&search, accepted, i, &own))
            .collect();
        let structure: Vec<usize> = accepted
            .iter()
            .copied()
            .filter(|&c| !self.candidates[c].effect.info().parameter)
            .collect();
        let free = self.refit(&search, &structure, &(0..own.len()).collect::<Vec<_>>());
        let enough = self.as_low(&own, &free);
        Run {
            search,
            selection,
            over_refit,
            rivalled: self.objective.settings.rivalled,
            enough,
        }
    }

    /// Whether no joint is left by far above what something else leaves there.
    fn as_low(&self, own: &[f64], other: &[f64]) -> bool {
        let s = self.objective.settings;
        let mut each = own.iter().zip(other);
        each.all(|(own, other)| {
            own <= &(s.rivalled * other) || own.sqrt() - other.sqrt() < s.visible
        })
    }

    /// Squared error of a fit by joint on folds left out, the floor added, relative to the torque.
    fn relative(&self, fit: &Fit) -> Vec<f64> {
        self.objective.relative_variance(&fit.error())
    }

    /// The same of the free refit with some causes in place, at the freedom that is best on some joints.
    fn refit(&self, search: &Search, causes: &[usize], joints: &[usize]) -> Vec<f64> {
        let sum = |e: &[f64]| joints.iter().map(|&j| e[j]).sum::<f64>();
        let of = |freedom: f64| {
            let mut variables = self.objective.base(self.model, freedom);
            variables.extend(causes.iter().flat_map(|&c| search.variables(c)));
            self.relative(&self.objective.fit(variables))
        };
        let [first, narrower @ ..] = self.objective.settings.freedoms;
        narrower.into_iter().map(of).fold(of(first), |best, next| {
            if sum(&next) < sum(&best) { next } else { best }
        })
    }

    /// Squared error with an absorbable cause in place over that of the free refit instead of it.
    fn over_refit(
        &self,
        search: &Search,
        accepted: &[usize],
        cause: usize,
        own: &[f64],
    ) -> Option<f64> {
        let candidate = &self.candidates[accepted[cause]];
        if !candidate.effect.info().absorbable || candidate.effect.info().parameter {
            return None;
        }
        let others = without(accepted, cause);
        let lacking = self.relative(&search.fit(&others));
        let fall: Vec<f64> = lacking.iter().zip(own).map(|(l, o)| l - o).collect();
        let most = fall.iter().copied().fold(0.0, f64::max);
        let touched = self.objective.settings.touched;
        let joints: Vec<usize> = (0..fall.len())
            .filter(|&j| fall[j] > 0.0 && fall[j] >= touched * most)
            .collect();
        let free = self.refit(search, &others, &joints);
        let sum = |e: &[f64]| joints.iter().map(|&j| e[j]).sum::<f64>();
        (!joints.is_empty()).then(|| sum(own) / sum(&free))
    }
}

impl<'a> Run<'a> {
    /// Accepted candidates that leave too much.
    fn beaten(&self) -> Vec<usize> {
        let each = self.selection.accepted.iter().zip(&self.over_refit);
        each.filter(|(_, r)| r.is_some_and(|r| r > self.rivalled))
            .map(|(&c, _)| c)
            .collect()
    }

    /// Accepted candidates that parameters can take over.
    fn single(&self) -> Vec<usize> {
        let each = self.selection.accepted.iter().zip(&self.over_refit);
        each.filter(|(_, r)| r.is_some()).map(|(&c, _)| c).collect()
    }

    /// −ln of how likely the recording is under the tolerances and the causes, nats, but for a constant: J, and what the width of
    /// the tolerances costs. A cause that parameters can absorb has to earn its name against wider tolerances, too; a body on the last
    /// link by every joint, whose number says how many of its ten coefficients show.
    fn surprise(&self) -> f64 {
        let Selection { accepted, fit } = &self.selection;
        let search = &self.search;
        let settings = search.objective.settings;
        let base = Fit::new(
            search.objective.grams,
            search.base.clone(),
            fit.weights.clone(),
        );
        let absorbable = accepted.iter().zip(&self.over_refit);
        let absorbable = absorbable.filter(|(_, over)| over.is_some());
        let name = |cause: usize| match search.candidates[cause].effect {
            Effect::Payload if !search.off(Rule::LastLink) => {
                settings.body * search.robot.dof() as f64
            }
            _ => settings.enough,
        };
        let names: f64 = absorbable.map(|(&cause, _)| name(cause)).sum();
        search.objective.of_fit(fit, 0) + search.charge(accepted) + base.width() + names
    }

    /// Whether nothing leaves too much.
    fn stands(&self) -> bool {
        self.enough && self.beaten().is_empty()
    }

    fn answer(self, within: impl Fn(usize) -> Option<f64>) -> Answer<'a> {
        let (steps, rest) = self.search.alternatives(&self.selection);
        let each = self.selection.accepted.iter().zip(&self.over_refit);
        let against = each.map(|(&cause, &over_refit)| Comparison {
            over_refit,
            within: over_refit.and_then(|_| within(cause)),
        });
        Answer {
            against: against.collect(),
            selection: self.selection,
            steps,
            rest,
            base: self.search.base,
        }
    }
}
