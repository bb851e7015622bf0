//! Search for the most probable set of hypotheses by adding, dropping, resizing and swapping them.

use super::material::Material;
use super::noise::Shape;
use super::posterior::{Group, Noise, Posterior, Rows};
use super::priors::{self, Places, Size};
use super::rows::JointRows;
use crate::search::model_comparison::Simplest;
use crate::search::objective::Freedom;
use crate::search::select::{Search, allowed};
use ::evidence::{Family, Hypothesis, log_prior};
use rayon::prelude::*;
use std::collections::HashSet;

/// Number of candidates of each screen whose evidence is computed with their own noise.
const CONTENDERS: usize = 5;

/// Least rise of the log posterior, nats: rounding must not keep the search going.
const RISE: f64 = 1e-6;

/// Candidate with its size.
pub(super) type Member = (usize, Size);

/// Set of hypotheses with its posterior.
pub(super) struct Found {
    /// Members of the set.
    pub set: Vec<Member>,
    /// Factors on the tolerances of the parameters.
    pub freedom: Freedom,
    /// Posterior of the parameters and the members' coefficients.
    pub posterior: Posterior,
    /// Log posterior, nats, up to a constant.
    value: f64,
}

/// Search for the most probable set of hypotheses.
pub(super) struct ByEvidence<'a> {
    simplest: &'a Simplest<'a>,
    search: Search<'a>,
    rows: Rows<'a>,
    hypotheses: Vec<Hypothesis>,
    families: Vec<Family>,
    /// Priors of each candidate's coefficients.
    groups: Vec<[Option<Group>; 2]>,
    /// Log prior of each candidate among the shapes of its place.
    shapes: Vec<f64>,
}

impl<'a> ByEvidence<'a> {
    /// Search on rows whose noise has the given `shapes`, by joint.
    pub(super) fn new(simplest: &'a Simplest<'a>, material: &Material, shapes: &[Shape]) -> Self {
        let dof = shapes.len();
        let joint = |j: usize| {
            JointRows::new(
                material.tables.columns(j),
                &material.features[j],
                material.y.column(j),
                material.weight.column(j),
                &material.frame.rows,
                shapes[j],
            )
        };
        let floor = simplest.objective.settings.floor;
        let rows = Rows {
            joints: (0..dof).into_par_iter().map(joint).collect(),
            layout: &simplest.objective.grams.layout,
            least: material
                .torque
                .iter()
                .map(|t| (floor * t).powi(2))
                .collect(),
        };
        let places = Places::new(simplest.candidates);
        let search = simplest.search(Vec::new(), HashSet::new());
        Self {
            groups: priors::groups(simplest, &search, material.torque),
            search,
            simplest,
            rows,
            hypotheses: places.hypotheses,
            families: places.families,
            shapes: places.shapes,
        }
    }

    /// Log prior of a set, nats.
    fn prior(&self, set: &[Member]) -> f64 {
        let shapes: f64 = set.iter().map(|m| self.shapes[m.0]).sum();
        let large = set.iter().filter(|m| m.1 == Size::Large);
        let traces: f64 = large.map(|m| self.simplest.candidates[m.0].evidence).sum();
        let all: Vec<usize> = set.iter().map(|m| m.0).collect();
        log_prior(&self.hypotheses, &self.families, &all) + shapes + traces
    }

    /// Prior of a member's coefficients.
    fn group(&self, (candidate, size): Member) -> &Group {
        let own = self.groups[candidate][size as usize].as_ref();
        own.expect("a member has a size that its candidate can have")
    }

    /// Set with its posterior under one freedom of the parameters; none where a coefficient is out of its bounds.
    fn at(&self, set: &[Member], freedom: Freedom, start: Option<&Noise>) -> Option<Found> {
        let base = self.simplest.objective.base(self.simplest.model, freedom);
        let groups: Vec<&Group> = set.iter().map(|&m| self.group(m)).collect();
        let posterior = self.rows.posterior(&base, &groups, start, true);
        let mut at = base.len();
        for &(c, _) in set {
            let candidate = &self.simplest.candidates[c];
            let own = at..at + candidate.bounds.len();
            at = own.end;
            let mut each = posterior.beta.iter().skip(own.start).zip(&candidate.bounds);
            if !each.all(|(b, bound)| allowed(*b, *bound)) {
                return None;
            }
        }
        let value = posterior.log_evidence + self.prior(set);
        Some(Found {
            set: set.to_vec(),
            freedom,
            posterior,
            value,
        })
    }

    /// Set under the freedom of the parameters under which it is most probable. Both factors are tried in turns from
    /// `from` on.
    fn freest(&self, set: &[Member], from: Freedom, start: Option<&Noise>) -> Option<Found> {
        let factors = self.simplest.objective.settings.tolerant;
        let near = |f: f64, from: f64| start.is_none() || (f / from).log2().abs() < 1.5;
        let best = |all: Vec<Freedom>| {
            let each = all.into_iter().filter_map(|f| self.at(set, f, start));
            each.max_by(|a, b| a.value.total_cmp(&b.value))
        };
        let links = best(
            factors
                .into_iter()
                .filter(|f| near(*f, from.links))
                .map(|links| Freedom { links, ..from })
                .collect(),
        )?;
        let from = links.freedom;
        best(
            factors
                .into_iter()
                .filter(|f| near(*f, from.friction))
                .map(|friction| Freedom { friction, ..from })
                .collect(),
        )
    }

    /// Most probable set that adding, dropping and swapping hypotheses leads to.
    pub(super) fn run(&self, start: Option<(Vec<Member>, Freedom)>) -> Found {
        let (set, freedom) = start.unwrap_or((Vec::new(), 1.0.into()));
        let begun = self.freest(&set, freedom, None);
        let empty = || self.freest(&[], 1.0.into(), None);
        let mut best = begun.or_else(empty).expect("no set has no bounds");
        let most = self.simplest.objective.settings.most_causes;
        while best.set.len() < most {
            let next = self.added(&best).or_else(|| self.dropped(&best));
            match next.or_else(|| self.swapped(&best)) {
                Some(next) => best = next,
                None => break,
            }
        }
        best
    }

    /// Better set with one hypothesis more, if there is one.
    fn added(&self, best: &Found) -> Option<Found> {
        let each = self.contenders(best, &best.set).into_iter();
        let mut found = self.weighed(best, each.map(|m| with(best.set.clone(), m)));
        found.retain(|f| f.value > best.value + RISE);
        found.sort_by(|a, b| b.value.total_cmp(&a.value));
        // Hypotheses on different joints are added together.
        let mut joints: Vec<usize> = Vec::new();
        let mut together = best.set.clone();
        for f in &found {
            let member = *f.set.last()?;
            let own = &self.simplest.candidates[member.0].joints;
            if own.iter().all(|j| !joints.contains(j)) {
                joints.extend(own);
                together.push(member);
            }
        }
        let single = found.into_iter().next()?;
        if together.len() > best.set.len() + 1
            && let Some(all) = self.freest(&together, single.freedom, Some(&single.posterior.noise))
            && all.value > single.value
        {
            return Some(all);
        }
        Some(single)
    }

    /// Better set with one hypothesis less, or of another size, if there is one.
    fn dropped(&self, best: &Found) -> Option<Found> {
        let less = (0..best.set.len()).map(|i| without_member(&best.set, i));
        let resized = (0..best.set.len()).filter_map(|i| {
            let (c, size) = best.set[i];
            let other = if size == Size::Small {
                Size::Large
            } else {
                Size::Small
            };
            self.groups[c][other as usize].as_ref()?;
            let mut set = best.set.clone();
            set[i].1 = other;
            Some(set)
        });
        self.better(best, less.chain(resized))
    }

    /// Better set with another hypothesis in the place of one, if there is one.
    fn swapped(&self, best: &Found) -> Option<Found> {
        let of = |i: usize| {
            let others = without_member(&best.set, i);
            let at = self.at(&others, best.freedom, Some(&best.posterior.noise));
            let instead = at.map_or_else(Vec::new, |at| self.contenders(&at, &best.set));
            instead.into_iter().map(move |m| with(others.clone(), m))
        };
        self.better(best, (0..best.set.len()).flat_map(of))
    }

    /// Most probable of some sets, where it is more probable than `best`.
    fn better(&self, best: &Found, sets: impl Iterator<Item = Vec<Member>>) -> Option<Found> {
        let found = self.weighed(best, sets);
        let next = found
            .into_iter()
            .max_by(|a, b| a.value.total_cmp(&b.value))?;
        (next.value > best.value + RISE).then_some(next)
    }

    /// Some sets with their posteriors.
    fn weighed(&self, best: &Found, sets: impl Iterator<Item = Vec<Member>>) -> Vec<Found> {
        let sets: Vec<Vec<Member>> = sets.collect();
        let noise = Some(&best.posterior.noise);
        let of = |set: Vec<Member>| {
            let changed = set.iter().filter(|m| !best.set.contains(m));
            let absorbed = changed.chain(best.set.iter().filter(|m| !set.contains(m)));
            let absorbed = absorbed.map(|m| self.simplest.candidates[m.0].effect.info());
            let free = absorbed.into_iter().any(|i| i.absorbable || i.parameter);
            if free {
                self.freest(&set, best.freedom, noise)
            } else {
                self.at(&set, best.freedom, noise)
            }
        };
        sets.into_par_iter().filter_map(of).collect()
    }

    /// Candidates that may be worth it beside a set: the best by the set's own noise, without unknown torques, and
    /// beside the parameters as given. Those at a place that is `taken` by the same candidate are not among them.
    fn contenders(&self, at: &Found, taken: &[Member]) -> Vec<Member> {
        let set: Vec<usize> = at.set.iter().map(|m| m.0).collect();
        let open: Vec<usize> = (0..self.simplest.candidates.len())
            .filter(|c| !taken.iter().any(|m| m.0 == *c) && self.search.open(*c, &set))
            .collect();
        let each = open
            .iter()
            .flat_map(|&c| [(c, Size::Small), (c, Size::Large)]);
        let all: Vec<Member> = each
            .filter(|m| self.groups[m.0][m.1 as usize].is_some())
            .collect();
        let added: Vec<&Group> = all.iter().map(|&m| self.group(m)).collect();
        let noise = &at.posterior.noise;
        let groups: Vec<&Group> = at.set.iter().map(|&m| self.group(m)).collect();
        let beside = |freedom: Freedom| {
            let base = self.simplest.objective.base(self.simplest.model, freedom);
            self.rows.posterior(&base, &groups, Some(noise), false)
        };
        let (known, tight) = (beside(at.freedom), beside(1.0.into()));
        let mut out: Vec<Member> = Vec::new();
        for posterior in [&at.posterior, &known, &tight] {
            let gains = self.rows.gains(posterior, &added);
            let each = all.iter().zip(gains).filter(|(m, (_, gamma))| {
                let bounds = &self.simplest.candidates[m.0].bounds;
                gamma.iter().zip(bounds).all(|(g, b)| allowed(*g, *b))
            });
            let mut ranked: Vec<(f64, Member)> = each
                .map(|(&m, (gain, _))| (gain + self.shapes[m.0], m))
                .collect();
            ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.0.cmp(&b.1.0)));
            // Of one effect at one place the best of each size.
            let mut seen: HashSet<(usize, usize)> = HashSet::new();
            ranked.retain(|(_, m)| seen.insert((self.hypotheses[m.0].parameters[0], m.1 as usize)));
            out.extend(ranked.iter().take(CONTENDERS).map(|(_, m)| *m));
        }
        out.sort_unstable_by_key(|m| (m.0, m.1 as usize));
        out.dedup();
        out
    }
}

/// Set with one member more.
fn with(mut set: Vec<Member>, member: Member) -> Vec<Member> {
    set.push(member);
    set
}

/// Set without the member at position `i`.
fn without_member(set: &[Member], i: usize) -> Vec<Member> {
    let each = set.iter().enumerate();
    each.filter(|(k, _)| *k != i).map(|(_, m)| *m).collect()
}
