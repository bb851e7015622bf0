//! Comparison of few parameters with many: whether a cause and changes of the given parameters within their
//! tolerance explain as much as a free refit of all parameters.
//!
//! Both are compared on trajectories left out, by squared error on the joints whose torque the cause changes. A
//! cause with more than `rivalled` times the refit's error stands in for a model that is wrong elsewhere. It is
//! barred and the search runs again, with wider tolerances where nothing else brings the error down.
//!
//! The true error of the given parameters is not known beforehand. Causes are searched under several factors on
//! their tolerances, and the factor is chosen under which the recording is likeliest.

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

/// Largest number of searches at each factor on the tolerances. Each further one bars one more cause.
const ROUNDS: usize = 6;

/// Causes that the search accepted, and their comparison with the free refit of the parameters.
pub struct Answer<'a> {
    /// Accepted causes and their fit.
    pub selection: Selection<'a>,
    /// All candidates tried in the place of each accepted cause, best first, with the other causes kept.
    pub steps: Vec<Vec<CandidateScore>>,
    /// All candidates tried beside the accepted causes, best first.
    pub rest: Vec<CandidateScore>,
    /// Base variables with the priors of the answer.
    pub base: Vec<Variable>,
    /// Comparison of each accepted cause with the free refit of the parameters.
    pub against: Vec<Comparison>,
}

/// Comparison of a cause with the free refit of the parameters. Empty for causes that parameters cannot absorb,
/// and for parameters.
#[derive(Clone, Copy, Debug, Default)]
pub struct Comparison {
    /// Ratio of the squared error with the cause to that of the free refit without it, below 1 where the cause is
    /// better.
    pub over_refit: Option<f64>,
    /// Largest factor on the given parameters' tolerances under which the cause is found. None where it is found under all.
    pub within: Option<f64>,
}

/// Comparison of models over one catalogue: it chooses the simplest causes that explain as much as a free refit.
pub struct Simplest<'a> {
    /// Criterion J by which causes are compared.
    pub objective: &'a Objective<'a>,
    /// Candidates of the catalogue.
    pub candidates: &'a [Candidate],
    /// Column numbers of each candidate.
    pub members: &'a [Vec<usize>],
    /// Model as given, to which the gap is measured.
    pub model: &'a NominalModel,
    /// Gain that a cause reaches by chance on this recording, nats.
    pub chance: f64,
}

/// Result of one forward search under given tolerances.
struct Run<'a> {
    /// Search that was run.
    search: Search<'a>,
    /// Accepted causes and their fit.
    selection: Selection<'a>,
    /// Ratio of each accepted cause's squared error to the free refit's; none for causes that parameters cannot absorb.
    over_refit: Vec<Option<f64>>,
    /// Ratio to the free refit's squared error above which a cause is rejected.
    rivalled: f64,
    /// Whether no joint's error is far above that of a free refit.
    enough: bool,
}

impl<'a> Simplest<'a> {
    /// Simplest causes whose error is not above the free refit's by more than the allowed ratio.
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
        let stand: Vec<bool> = runs.iter().map(|(_, _, run)| run.stands()).collect();
        let barred = settings.off.applies(Rule::Barred, stand.contains(&false));
        let runs = runs.into_iter().zip(stand);
        let standing = runs
            .filter(|(_, stands)| *stands || !barred)
            .map(|(run, _)| run);
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
                // Causes to bar: those above the refit's error, or all absorbable ones where only their total error is
                // too high.
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

    /// Largest factor on the tolerances under which a cause of the same effect and joints is found. None where it is
    /// found under the largest of all, or under none.
    fn within(&self, found: &[(f64, Vec<usize>)], cause: usize) -> Option<f64> {
        let alike = self.alike(&[cause]);
        let has = |accepted: &[usize]| accepted.iter().any(|c| alike.contains(c));
        let widest = found.iter().rposition(|(_, accepted)| has(accepted))?;
        (widest + 1 < found.len()).then(|| found[widest].0)
    }

    /// Factor on the friction tolerances under which the recording is likeliest without any cause. It is one of the
    /// setting `tolerant`; wide ones are penalised. `links` is the one factor on the tolerances of all links.
    ///
    /// With one factor on both, correct friction would keep the links' tolerance small, and an error of the last
    /// link would look like a payload.
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

    /// Result of the search without candidates that free all ten parameters of a link. It counts where it needs fewer
    /// coefficients and is not above the refit's error. Otherwise the result with these candidates.
    fn fewer(&self, freedom: Freedom) -> Run<'a> {
        let full = self.run(freedom, HashSet::new());
        let many = |c: usize| self.is_many(c);
        let off = &self.objective.settings.off;
        let freed = full.selection.accepted.iter().any(|&c| many(c));
        if off.holds(Rule::FullLink) || !freed {
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
        let fewer = named && few.stands() && price(&few) < price(&full) && low();
        if off.applies(Rule::FullLink, fewer) {
            few
        } else {
            full
        }
    }

    /// Whether a candidate is the full set of a link's ten parameters.
    fn is_many(&self, candidate: usize) -> bool {
        self.candidates[candidate].effect == Effect::LinkParameters
            && self.members[candidate].len() == PARAMETERS_PER_LINK
    }

    /// Indices of the candidates with the same effect and joints as one of `some`.
    fn alike(&self, some: &[usize]) -> Vec<usize> {
        let same = |c: &usize| {
            some.iter().any(|&s| {
                let (a, b) = (&self.candidates[s], &self.candidates[*c]);
                a.effect == b.effect && a.joints == b.joints
            })
        };
        (0..self.candidates.len()).filter(same).collect()
    }

    /// Search beside the given base variables, without the `barred` candidates.
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

    /// Forward search under tolerances times `freedom`, without the `barred` candidates, compared with the free refit.
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

    /// Whether no joint's error is far above that of another fit there.
    fn as_low(&self, own: &[f64], other: &[f64]) -> bool {
        let s = self.objective.settings;
        let mut each = own.iter().zip(other);
        each.all(|(own, other)| {
            own <= &(s.rivalled * other) || own.sqrt() - other.sqrt() < s.visible
        })
    }

    /// Squared error of a fit by joint on folds left out plus the floor, relative to the joint's squared torque.
    fn relative(&self, fit: &Fit) -> Vec<f64> {
        self.objective.relative_variance(&fit.error())
    }

    /// Squared error of each joint, relative to its squared torque, of a free refit of the parameters beside `causes`.
    /// The factor on the tolerances is the one with the least error on `joints`.
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

    /// Squared error with an absorbable cause over that of the free refit without it. None for all other causes.
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
    /// Accepted causes whose squared error is above `rivalled` times the free refit's.
    fn beaten(&self) -> Vec<usize> {
        let each = self.selection.accepted.iter().zip(&self.over_refit);
        each.filter(|(_, r)| r.is_some_and(|r| r > self.rivalled))
            .map(|(&c, _)| c)
            .collect()
    }

    /// Accepted causes that parameters can absorb, whose error was compared with the refit's.
    fn single(&self) -> Vec<usize> {
        let each = self.selection.accepted.iter().zip(&self.over_refit);
        each.filter(|(_, r)| r.is_some()).map(|(&c, _)| c).collect()
    }

    /// Negative log-likelihood of the recording under the tolerances and causes, nats, up to a constant: J plus the
    /// penalty of wide tolerances. A cause that parameters can absorb pays an extra price, as wider tolerances could
    /// explain it. A body on the last link pays per joint, whose number limits how many of its ten coefficients show.
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

    /// Whether no cause has an error above the allowed ratio, and no joint's error is far above a free refit's.
    fn stands(&self) -> bool {
        self.enough && self.beaten().is_empty()
    }

    /// Answer with the causes of this run. `within` gives the largest factor on the tolerances under which a cause is
    /// found.
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
