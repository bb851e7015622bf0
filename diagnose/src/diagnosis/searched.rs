//! Repeated search on the fitted recording: without pushed samples, and above the chance level.

use super::options::Options;
use super::{autocorrelation, reversal_weights};
use crate::catalogue::effect::Effect;
use crate::catalogue::gear::Link;
use crate::error::DiagnoseError;
use crate::input::frames::{Frames, ResidualNoise};
use crate::ladder::listing::{Listing, list};
use crate::ladder::out_of_fold::OutOfFold;
use crate::ladder::scores::{Scored, total};
use crate::measure::verdict::{dead, moves};
use crate::motion::scene::Scene;
use crate::motion::standing::{Coulomb, Judged, judge, states};
use crate::schema::NotIdentifiable;
use crate::search::find::{Findings, find, gap};
use crate::search::session::Session;
use crate::settings::{Rule, Settings};
use crate::simulator::NominalModel;
use crate::surrogates::{self, Null};
use crate::traces::contact::{Contact, detect, suspected};
use crate::traces::unknown::{Misfit, examine};
use datasets::metrics::Scope;
use ndarray::Array2;
use std::sync::Arc;

/// Usable joints of the fitted recording.
pub(super) struct Channels {
    /// Whether each joint lacks a usable torque channel.
    pub dead: Vec<bool>,
    /// Whether some joint with a usable torque channel moves long enough to be judged.
    pub moves: bool,
}

impl Channels {
    pub(super) fn new(frames: &Frames, settings: &Settings) -> Self {
        let judging = &settings.measure.verdict;
        let dead = dead(&frames.data, judging);
        let states = states(&frames.data, &settings.motion);
        Self {
            moves: moves(&frames.data, &states, &dead, judging),
            dead,
        }
    }

    /// Entry of the report for each joint without a usable torque channel.
    pub(super) fn unusable(&self, names: &[String]) -> Vec<NotIdentifiable> {
        let dead = names.iter().zip(&self.dead).filter(|(_, dead)| **dead);
        let said = dead.map(|(name, _)| NotIdentifiable {
            effect: None,
            joints: vec![name.clone()],
            reason: format!(
                "{name} has no usable torque channel: nearly every sample has one value"
            ),
        });
        said.collect()
    }
}

/// Result of one search with some samples left out.
struct Search {
    findings: Findings,
    listing: Listing,
    left: Vec<Option<Misfit>>,
    judged: Judged,
    /// Torque that the links need at the recorded samples, N·m (N), shape (samples, joints).
    load: Array2<f64>,
}

/// Result of the repeated search.
pub(super) struct Searched {
    /// Accepted causes of the last search, with their fit.
    pub findings: Findings,
    /// Listing of the accepted causes.
    pub listing: Listing,
    /// Structure in the residual of the listed causes, by joint.
    pub left: Vec<Option<Misfit>>,
    /// Structure in the residual as the verdict uses it, by joint: where pushes are known, the one beside weaker
    /// pushes.
    pub beside: Vec<Option<Misfit>>,
    /// Residual of the listed causes, judged by the joints' state of motion.
    pub judged: Judged,
    /// Pushes in the fitted recording.
    pub contact: Option<Contact>,
    /// Search for pushes in the held-out recording: none where it is off, else whether joints in motion are searched, too.
    pub look: Option<bool>,
    /// Recorded samples in a push or near one, which are neither fitted nor scored.
    pub skipped: Vec<bool>,
    /// Null distribution of gains on this recording, where surrogates were drawn.
    pub null: Option<Null>,
}

/// State that all searches of one diagnosis share.
pub(super) struct Searcher<'a> {
    model: &'a NominalModel,
    frames: &'a Frames,
    channels: &'a Channels,
    options: &'a Options,
    /// Weights of the fitted rows, shape (rows, joints).
    pub(super) weight: Array2<f64>,
}

impl<'a> Searcher<'a> {
    pub(super) fn new(
        model: &'a NominalModel,
        frames: &'a Frames,
        channels: &'a Channels,
        options: &'a Options,
    ) -> Self {
        let mut weight = frames.data.weights(&options.settings.motion);
        if let Some(turning) = &frames.turning {
            weight = at_most(weight, turning);
        }
        let columns = weight.columns_mut().into_iter().zip(&channels.dead);
        for (mut column, _) in columns.filter(|d| *d.1) {
            column.fill(0.0);
        }
        Self {
            model,
            frames,
            channels,
            options,
            weight,
        }
    }

    /// Gain by chance, nats: the largest of the robot's own model where nothing has changed.
    fn chance(&self) -> f64 {
        let earlier = self.options.earlier.as_ref();
        earlier.map_or(0.0, |e| e.chance(self.frames.data.len()))
    }

    /// Findings of a search of the whole recording.
    pub(super) fn first(&self, session: Option<Arc<Session>>) -> Result<Findings, DiagnoseError> {
        self.find(&self.weight, self.chance(), session)
    }

    /// Session that a further search of the same frames can reuse, whatever its row weights. None where a
    /// link's encoder determined a gear, since that depends on the rows.
    pub(super) fn known(found: &Findings) -> Option<Arc<Session>> {
        let said = |link: &Link| !matches!(link, Link::Unknown);
        let session = &found.session;
        (!session.links.iter().any(said)).then(|| Arc::clone(session))
    }

    /// Noise of the rows from the out-of-fold residual of a search.
    pub(super) fn left(&self, found: &Findings) -> ResidualNoise {
        let (frames, data) = (self.frames, &self.frames.data);
        let motion = &self.options.settings.motion;
        let gap = gap(self.model, data, &frames.scale);
        let unseen = OutOfFold::new(found, frames, &gap, &self.weight);
        let left = data.table_thin(&unseen.residual(&found.tight_fit(&frames.scale)));
        let turning = reversal_weights::weights(&left, data, motion);
        let weight = at_most(data.weights(motion), &turning);
        ResidualNoise {
            correlation_rows: autocorrelation::of_joints(&left, &weight, &data.rows),
            turning,
        }
    }

    /// Structure beside pushes, by joint: the lesser of that on all rows, and that without the loudest part of the
    /// remaining recording. A person who pushes visibly also pushes weakly; without that part weak pushes do not pass
    /// for an unknown effect.
    fn beside(&self, found: &Search, skipped: &[bool]) -> Vec<Option<Misfit>> {
        let settings = &self.options.settings;
        let data = &self.frames.data;
        let part = settings.traces.contact.suspected;
        let mut out = suspected(data, &found.judged, skipped, part);
        out.iter_mut().zip(skipped).for_each(|(o, s)| *o |= s);
        let out = data.pick(|i| out[i]);
        let without = examine(data, &found.listing.residual, &out, settings);
        let each = found.left.iter().zip(without);
        let least = |(all, without): (&Option<Misfit>, Option<Misfit>)| {
            let both = all.iter().copied().chain(without);
            both.min_by(|a, b| a.structured().total_cmp(&b.structured()))
        };
        each.map(least).collect()
    }

    /// Causes and pushes. `first` are the findings of [`Self::first`].
    pub(super) fn searched(&self, first: Findings) -> Result<Searched, DiagnoseError> {
        let samples = self.frames.data.tau.nrows();
        let found = self.listed(first, &self.weight, &vec![false; samples]);
        let look = (self.options.effects.holds(Effect::ExternalContact))
            .then(|| !self.repeats(&found.left));
        let contact = self.contact(&found, look)?;
        let (found, contact, skipped) = self.apart(found, contact)?;
        let weight = self.without(&skipped);
        let (found, null) = self.above_chance(found, &weight, &skipped)?;
        let off = &self.options.settings.search.off;
        let beside = match contact {
            Some(_) if off.applies(Rule::BesidePushes, true) => self.beside(&found, &skipped),
            _ => found.left.clone(),
        };
        Ok(Searched {
            look: look.map(|_| !self.repeats(&found.left)),
            findings: found.findings,
            listing: found.listing,
            left: found.left,
            beside,
            judged: found.judged,
            contact,
            skipped,
            null,
        })
    }

    /// Findings of a search; samples that are left out have zero weight.
    fn find(
        &self,
        weight: &Array2<f64>,
        chance: f64,
        session: Option<Arc<Session>>,
    ) -> Result<Findings, DiagnoseError> {
        let own = self.options.settings.clone();
        let effects = self.options.effects;
        find(
            self.model,
            self.frames,
            weight,
            own,
            effects,
            chance,
            session,
        )
    }

    /// One further search without the `skipped` samples, which have zero weight. `known` is a session to reuse.
    fn search(
        &self,
        weight: &Array2<f64>,
        skipped: &[bool],
        chance: f64,
        known: Option<Arc<Session>>,
    ) -> Result<Search, DiagnoseError> {
        Ok(self.listed(self.find(weight, chance, known)?, weight, skipped))
    }

    /// Listed causes, residual and structure of a search's findings.
    fn listed(&self, mut findings: Findings, weight: &Array2<f64>, skipped: &[bool]) -> Search {
        let (model, frames, settings) = (self.model, self.frames, &self.options.settings);
        let data = &frames.data;
        let scored = Scored::new(&self.channels.dead, skipped.iter().map(|s| !s).collect());
        let (effects, moves) = (self.options.effects, self.channels.moves);
        let listing = list(
            model,
            frames,
            &mut findings,
            weight,
            &scored,
            effects,
            moves,
        );
        let left = examine(
            data,
            &listing.residual,
            &data.pick(|i| skipped[i]),
            settings,
        );
        let scene = Scene::new(&findings.session.present, frames.passage(), &frames.scale);
        let load = data.table_to_samples(&scene.rigid);
        let coulomb = Coulomb {
            torque: listing.coulomb.clone(),
            sign: data.table_to_samples(&scene.sign),
        };
        let judged = judge(data, &listing.residual, &coulomb, &settings.motion);
        Search {
            findings,
            listing,
            left,
            judged,
            load,
        }
    }

    /// Weights with zeros at the samples `out`.
    fn without(&self, out: &[bool]) -> Array2<f64> {
        let mut weight = self.weight.clone();
        let rows = weight.rows_mut().into_iter();
        let near = rows.zip(self.frames.data.pick(|i| out[i]));
        near.filter(|r| r.1).for_each(|(mut row, _)| row.fill(0.0));
        weight
    }

    /// Whether a residual has clear structure on some joint for which `learnable` holds.
    fn structured(&self, left: &[Option<Misfit>], learnable: impl Fn(&Misfit) -> bool) -> bool {
        let clear = self.options.settings.measure.verdict.clear;
        let mut left = left.iter().flatten();
        left.any(|l| l.structured() > clear && learnable(l))
    }

    /// Whether a learner predicts the residual from motion. If so, the residual repeats with the motion and cannot be
    /// contact.
    fn repeats(&self, left: &[Option<Misfit>]) -> bool {
        let most = self.options.settings.traces.contact.learnable;
        self.structured(left, |l| l.learnable > most)
    }

    /// Pushes in the residual of a search; with `moving` also on joints in motion.
    fn pushed(&self, found: &Search, moving: bool) -> Option<Contact> {
        let pushes = &self.options.settings.traces.contact;
        let data = &self.frames.data;
        let whole = Scored::new(&self.channels.dead, vec![true; data.tau.nrows()]);
        let rest = whole.figures(&found.listing.residual, data, Scope::All);
        let least = pushes.least(found.listing.given, total(&rest));
        detect(data, &found.judged, &found.load, moving, pushes)
            .filter(|c| c.at_rest || c.size > least)
    }

    /// Pushes of the whole recording, where they are searched.
    fn contact(
        &self,
        found: &Search,
        look: Option<bool>,
    ) -> Result<Option<Contact>, DiagnoseError> {
        let contact = look.and_then(|moving| self.pushed(found, moving));
        // A push on few trajectories bends the fit until nothing stands out any more.
        if contact.is_some() || look != Some(true) || !self.structured(&found.left, |_| true) {
            return Ok(contact);
        }
        let part = self.options.settings.traces.contact.suspected;
        let none = vec![false; self.frames.data.tau.nrows()];
        let suspected = suspected(&self.frames.data, &found.judged, &none, part);
        let known = Self::known(&found.findings);
        let clean = self.search(&self.without(&suspected), &suspected, self.chance(), known)?;
        Ok(self.pushed(&clean, true))
    }

    /// The search without pushed samples, all pushes found, and the samples left out for them. Without the
    /// pushes the fit shows further ones, so this is repeated.
    fn apart(
        &self,
        mut found: Search,
        mut contact: Option<Contact>,
    ) -> Result<(Search, Option<Contact>, Vec<bool>), DiagnoseError> {
        let data = &self.frames.data;
        let mut skipped = vec![false; data.tau.nrows()];
        let margin = self.options.settings.traces.contact.margin;
        let margin = (margin * data.report().rate_hz) as usize;
        let mut near = contact.as_ref().map(|c| c.pushed(skipped.len(), margin));
        while let Some(cut) = near.take() {
            let first = skipped.iter().all(|s| !s);
            skipped.iter_mut().zip(cut).for_each(|(s, n)| *s |= n);
            let known = Self::known(&found.findings);
            drop(found);
            found = self.search(&self.without(&skipped), &skipped, self.chance(), known)?;
            let more = |c: &Contact| contact.as_ref().is_some_and(|known| c.size > known.size);
            let again = || self.pushed(&found, !self.repeats(&found.left)).filter(more);
            if first && let Some(all) = again() {
                near = Some(all.pushed(skipped.len(), margin));
                contact = Some(all);
            }
        }
        Ok((found, contact, skipped))
    }

    /// Findings without causes whose gain chance reaches as well on this recording.
    fn above_chance(
        &self,
        found: Search,
        weight: &Array2<f64>,
        skipped: &[bool],
    ) -> Result<(Search, Option<Null>), DiagnoseError> {
        let (model, frames, surrogates) = (self.model, self.frames, self.options.surrogates);
        let short = frames.data.is_short(&self.options.settings.ladder);
        if surrogates == 0 || short || !self.channels.moves {
            return Ok((found, None));
        }
        let null = surrogates::with(model, frames, &found.findings, weight, |source| {
            source.null(0..surrogates)
        });
        if found.findings.least_earned() > null.level() {
            return Ok((found, Some(null)));
        }
        let known = Self::known(&found.findings);
        drop(found);
        let level = null.level().max(self.chance());
        let found = self.search(weight, skipped, level, known)?;
        Ok((found, Some(null)))
    }
}

/// The smaller of two weights, row by row.
fn at_most(weight: Array2<f64>, most: &Array2<f64>) -> Array2<f64> {
    ndarray::Zip::from(&weight)
        .and(most)
        .map_collect(|a, b| a.min(*b))
}
