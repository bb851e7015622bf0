//! Search for the causes of a recording: torque gap, first fit of the parameters, candidates of the catalogue, accepted
//! causes.

use crate::algebra::fit::Variable;
use crate::algebra::folds::Fold;
use crate::algebra::gram::Grams;
use crate::catalogue::choice::Choice;
use crate::catalogue::effect::Effect;
use crate::catalogue::gear::Link;
use crate::catalogue::{
    Candidate, backlash, position_dependent_friction, saturation, torque_ripple,
};
use crate::error::DiagnoseError;
use crate::input::frames::Frames;
use crate::motion::frame::Frame;
use crate::motion::scene::{Scale, Scene};
use crate::search::carried_body;
use crate::search::dictionary::Dictionary;
use crate::search::model_comparison::{Answer, Comparison, Simplest};
use crate::search::objective::Objective;
use crate::search::on_time::on_time;
use crate::search::products::Rows;
use crate::search::select::CandidateScore;
use crate::search::session::Session;
use crate::search::short_recordings::pieces;
use crate::settings::{Rule, Settings};
use crate::simulator::NominalModel;
use crate::traces::impacts::Blows;
use crate::traces::order::Orders;
use datasets::check::plateau;
use ndarray::{Array1, Array2, ArrayView1, Axis};
use physics::robot::{PARAMETERS_PER_LINK, Robot};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Accepted cause with its place in the fit.
#[derive(Clone, Debug)]
pub struct Accepted {
    /// Index of the accepted candidate in the catalogue.
    pub candidate: usize,
    /// Indices of its variables in the fit.
    pub variables: Range<usize>,
    /// Scores of all candidates tried in the cause's place, best first.
    pub tried: Vec<CandidateScore>,
    /// Comparison of the cause with a free refit of the parameters.
    pub against: Comparison,
}

/// Result of the search for causes.
pub struct Findings {
    /// State shared with other searches of the recording.
    pub session: Arc<Session>,
    /// Candidates of the catalogue, and those that were derived from this recording's torque, such as its periodic
    /// lines.
    pub candidates: Vec<Candidate>,
    /// Columns of the candidates.
    pub dictionary: Dictionary,
    /// Sums of products of the columns and the gap over the fitted rows, by fold.
    pub grams: Grams,
    /// Number of base variables (the parameters of the given model), which are the first in every fit.
    pub base: usize,
    /// Causes in the order of acceptance.
    pub accepted: Vec<Accepted>,
    /// Variables and coefficients of the final fit, in which the base stays near the given parameters.
    pub tight: (Vec<Variable>, Array1<f64>),
    /// Standard deviations of the coefficients in `tight`; see
    /// [`Fit::deviations`](crate::algebra::fit::Fit::deviations).
    pub std: Array1<f64>,
    /// Scores of the candidates tried beside the accepted causes, best first.
    pub rest: Vec<CandidateScore>,
    /// Factor on the tolerances of the given parameters where they are identified again beside the accepted causes.
    pub freedom: f64,
    /// Thresholds of the diagnosis.
    pub settings: Settings,
}

/// Torque gap: measured minus predicted torque at the recorded samples, N·m (N), shape (samples, joints).
pub fn gap(model: &NominalModel, frame: &Frame, scale: &Scale) -> Array2<f64> {
    &frame.tau - &model.predicted(frame, scale)
}

/// Chosen columns of a recording at its recorded samples: (column, joint, torque per unit).
pub struct Columns(Vec<(usize, usize, Array1<f64>)>);

impl Columns {
    /// Evaluates the columns of `variables` on a recording. `scene` must hold the motion of `frame`.
    pub fn new(
        dictionary: &Dictionary,
        scene: &Scene,
        frame: &Frame,
        variables: &[Variable],
    ) -> Self {
        let mut ids: Vec<usize> = variables.iter().map(|v| v.column).collect();
        ids.sort_unstable();
        ids.dedup();
        let mut out: Vec<(usize, usize, Vec<f64>)> = Vec::new();
        let resampled = |at: Range<usize>, fine: &[&Array1<f64>]| frame.resample(at, fine);
        dictionary.by_part(scene, &ids, resampled, |_, values| {
            if out.is_empty() {
                out = values.iter().map(|v| (v.0, v.1, Vec::new())).collect();
            }
            let each = out.iter_mut().zip(values);
            each.for_each(|(out, (_, _, x))| out.2.extend(x));
        });
        let out = out.into_iter();
        Self(out.map(|(c, j, x)| (c, j, Array1::from(x))).collect())
    }

    /// Torque of the given coefficients, shape (samples, joints).
    pub fn torque(
        &self,
        shape: (usize, usize),
        variables: &[Variable],
        beta: &Array1<f64>,
    ) -> Array2<f64> {
        let mut out = Array2::zeros(shape);
        self.add(&mut out, 0..shape.0, variables, beta);
        out
    }

    /// Adds the torque of the given coefficients on some samples to `out`, shape (samples, joints).
    pub fn add(
        &self,
        out: &mut Array2<f64>,
        samples: Range<usize>,
        variables: &[Variable],
        beta: &Array1<f64>,
    ) {
        let mut by_column = std::collections::HashMap::new();
        for (v, b) in variables.iter().zip(beta) {
            *by_column.entry(v.column).or_insert(0.0) += b;
        }
        let mut out = out.slice_axis_mut(Axis(0), samples.clone().into());
        for (c, j, x) in &self.0 {
            if let Some(&b) = by_column.get(c) {
                out.column_mut(*j)
                    .scaled_add(b, &x.slice_axis(Axis(0), samples.clone().into()));
            }
        }
    }
}

/// Finds the causes among `effects`. A candidate whose gain is at most `chance` (nats) is not accepted. `weight` has
/// the weight of each fitted row, shape (rows, joints). `session` is that of an earlier search of the same frames,
/// where there was one.
///
/// # Errors
/// Model of the first fit that is invalid.
pub fn find(
    model: &NominalModel,
    frames: &Frames,
    weight: &Array2<f64>,
    settings: Settings,
    effects: Choice,
    chance: f64,
    session: Option<Arc<Session>>,
) -> Result<Findings, DiagnoseError> {
    let (data, scale) = (&frames.data, &frames.scale);
    let off = settings.search.off.clone();
    let gap = gap(model, data, scale);
    let y = data.table_thin(&gap);
    let folds = data.folds();
    let given = Scene::new(&model.robot, frames.passage(), scale);
    let punctual = given.lateness().map(|l| &gap - &data.table_to_samples(&l));
    let left = punctual.as_ref().unwrap_or(&gap);
    let (fitted, residual) = first_fit(model, frames, &given, left, weight, &settings)?;
    let present = session.as_ref().map_or(fitted, |g| g.present.clone());
    let scene = Scene::new(&present, frames.passage(), scale);
    let session = match session {
        Some(known) => known,
        None => Arc::new(Session::new(&scene, data, weight, effects, model)),
    };
    let mut candidates = session.candidates.clone();
    let on_time = on_time(&scene, data, &residual, weight);
    let seen = |j: usize| -> Vec<Candidate> {
        let (q, qd) = (data.samples().q.column(j), data.samples().qd.column(j));
        let lines = |residual: ArrayView1<f64>, most| {
            Orders::new(residual, q, scale.speed[j], data.report().rate_hz)
                .map_or_else(Vec::new, |o| o.lines(most))
        };
        let orders = lines(on_time.column(j), torque_ripple::LINES);
        let mut seen = torque_ripple::candidates(j, &orders);
        // Friction lines: friction changes sign with velocity, so its lines are searched in residual times the sign of
        // velocity.
        let resisting = &on_time.column(j) * &qd.mapv(|v| (v / scale.softness[j]).tanh());
        let orders = lines(resisting.view(), position_dependent_friction::LINES);
        seen.extend(position_dependent_friction::candidates(&scene, j, &orders));
        let flat = plateau(&data.tau.column(j).to_vec());
        seen.extend(flat.map(|(limit, _)| saturation::flat_top(j, limit)));
        seen
    };
    let each: Vec<Vec<Candidate>> = (0..data.dof()).into_par_iter().map(seen).collect();
    candidates.extend(each.into_iter().flatten());
    let load = data.table_to_samples(&scene.rigid);
    let asked = &settings.traces.blows;
    if let Some(blows) = Blows::new(data, &residual, &load, asked)
        && let Some(clearest) = blows.clearest()
        && matches!(session.links[clearest.joint], Link::Unknown)
    {
        let shown = Some(blows.chance(&clearest)).filter(|chance| *chance <= asked.chance);
        let shown = shown.filter(|_| off.applies(Rule::Trace, true));
        candidates.extend(backlash::struck(&scene, clearest.joint, shown));
    }
    effects.retain(&mut candidates);
    let any = candidates.iter().any(|c| c.evidence != 0.0);
    if any && !off.applies(Rule::Evidence, any) {
        candidates.iter_mut().for_each(|c| c.evidence = 0.0);
    }
    let dictionary = Dictionary::new(data.dof(), &candidates);
    let rows = Rows {
        dictionary: &dictionary,
        scene: &scene,
        frame: data,
        weight,
        kept: Some(&session.kept),
    };
    let grams = rows.grams(&y);
    drop(scene);
    let objective = Objective::new(&grams, scale, &settings.search);
    let simplest = Simplest {
        objective: &objective,
        candidates: &candidates,
        members: &dictionary.members,
        model,
        chance,
    };
    let mut answer = simplest.answer();
    if off.applies(Rule::Short, data.is_short(&settings.ladder)) {
        let rows = |fold: &Fold| fold.scored.iter().map(ExactSizeIterator::len).sum();
        let rows: Vec<usize> = folds.iter().map(rows).collect();
        let pieces = pieces(&rows, settings.ladder.piece * data.row_rate());
        answer = simplest.halving(answer, &pieces, &settings.ladder);
    }
    let Answer {
        mut selection,
        steps,
        rest,
        base,
        against,
    } = answer;
    let mut start = base.len();
    let accepted: Vec<Accepted> = selection
        .accepted
        .iter()
        .zip(steps)
        .zip(against)
        .map(|((&candidate, tried), against)| {
            let variables = start..start + dictionary.members[candidate].len();
            start = variables.end;
            Accepted {
                candidate,
                variables,
                tried,
                against,
            }
        })
        .collect();
    let mut variables = selection.fit.variables.clone();
    let carried = |a: &&Accepted| candidates[a.candidate].effect == Effect::Payload;
    if let Some(body) = accepted.iter().find(carried).map(|a| a.variables.clone()) {
        let beta = selection.fit.beta().to_vec();
        let (own, beta) = (&mut variables[body.clone()], &beta[body]);
        carried_body::centre(own, beta, settings.search.freed);
        selection.fit = objective.fit(variables);
    }
    let tight = (
        selection.fit.variables.clone(),
        selection.fit.beta().clone(),
    );
    let std = selection.fit.deviations();
    Ok(Findings {
        session,
        candidates,
        dictionary,
        grams,
        base: base.len(),
        accepted,
        tight,
        std,
        rest,
        freedom: settings.search.freedoms[0],
        settings,
    })
}

/// Fit of the parameters alone, near the given ones. Returns the model that derived columns are built on, and
/// the residual at the recorded samples, shape (samples, joints).
fn first_fit(
    model: &NominalModel,
    frames: &Frames,
    given: &Scene,
    gap: &Array2<f64>,
    weight: &Array2<f64>,
    settings: &Settings,
) -> Result<(Robot, Array2<f64>), DiagnoseError> {
    let data = &frames.data;
    let dictionary = Dictionary::new(data.dof(), &[]);
    let y = data.table_thin(gap);
    let rows = Rows {
        dictionary: &dictionary,
        scene: given,
        frame: data,
        weight,
        kept: None,
    };
    let grams = rows.grams(&y);
    let objective = Objective::new(&grams, &frames.scale, &settings.search);
    let base = objective.base(model, 1.0);
    let fit = objective.fit(base.clone());
    let columns = Columns::new(&dictionary, given, data, &base);
    let residual = gap - &columns.torque(gap.dim(), &base, fit.beta());
    Ok((model.moved(&fit.beta().to_vec())?, residual))
}

impl Findings {
    /// Parameters of the model (10 N inertial, N viscous, N Coulomb) that the final fit's variables change. Each entry
    /// has variable, parameter, and change of the parameter per unit of the variable.
    pub fn parameter_map(&self) -> Vec<(usize, usize, f64)> {
        let variables = self.tight.0.iter().enumerate();
        let mut map: Vec<(usize, usize, f64)> = variables
            .filter(|(_, v)| v.column < self.base)
            .map(|(i, v)| (i, v.column, 1.0))
            .collect();
        for accepted in &self.accepted {
            let candidate = &self.candidates[accepted.candidate];
            let first = PARAMETERS_PER_LINK * candidate.joints[0];
            let sizes = candidate.change.into_iter().flatten().enumerate();
            let sizes = sizes.filter(|(_, size)| *size != 0.0);
            map.extend(sizes.map(|(p, size)| (accepted.variables.start, first + p, size)));
        }
        map
    }

    /// Whether a variable of the final fit belongs to a cause of kind `structure`, as a payload's do.
    pub fn is_structure(&self, variable: usize) -> bool {
        let structure = self.structure();
        let mut causes = structure.iter().map(|&c| &self.accepted[c].variables);
        causes.any(|own| own.contains(&variable))
    }

    /// Change of each parameter of the model (10 N inertial, N viscous, N Coulomb) by the variables that `keep`
    /// selects, and its standard deviation. Of several coefficients of one parameter the smallest deviation is
    /// taken. Infinite where no coefficient changes it.
    pub fn changes(&self, keep: impl Fn(usize) -> bool) -> Vec<(f64, f64)> {
        let mut out = vec![(0.0, f64::INFINITY); self.base];
        let beta = &self.tight.1;
        for (i, parameter, size) in self.parameter_map().into_iter().filter(|m| keep(m.0)) {
            let (sum, least) = &mut out[parameter];
            *sum += beta[i] * size;
            *least = least.min(self.std[i] * size.abs());
        }
        out
    }

    /// Fall of J by a candidate's own columns, nats, without evidence from a trace or another sensor.
    pub fn earned(&self, tried: &CandidateScore) -> f64 {
        tried.gain - self.candidates[tried.candidate].evidence
    }

    /// Fall of J by each accepted cause's own columns, nats. Parameters, and causes that a trace identifies, are left
    /// out.
    fn each_earned(&self) -> impl Iterator<Item = f64> {
        self.accepted.iter().filter_map(|a| {
            let mut tried = a.tried.iter();
            let own = tried.find(|t| t.candidate == a.candidate)?;
            let c = &self.candidates[a.candidate];
            let judged = !c.effect.info().parameter && c.shown.is_none();
            judged.then(|| self.earned(own))
        })
    }

    /// Smallest fall of J, nats, by an accepted cause's own columns. Parameters, and causes that a trace identifies, do
    /// not count. Infinite without causes.
    pub fn least_earned(&self) -> f64 {
        self.each_earned().fold(f64::INFINITY, f64::min)
    }

    /// Largest fall of J, nats, by an accepted cause's own columns. Parameters, and causes that a trace identifies, do
    /// not count. Zero without causes.
    pub fn most_earned(&self) -> f64 {
        self.each_earned().fold(0.0, f64::max)
    }

    /// Whether a trace identifies the accepted cause without the criterion J, as in
    /// [`Search::by_trace`](crate::search::select::Search). It does not where the same effect is accepted at another
    /// place.
    pub fn by_trace(&self, cause: usize) -> bool {
        let c = self.candidate(cause);
        let same = |other: usize| other != cause && self.candidate(other).effect == c.effect;
        c.shown.is_some() && !(0..self.accepted.len()).any(same)
    }

    /// Candidate of the accepted cause with this index.
    pub fn candidate(&self, cause: usize) -> &Candidate {
        &self.candidates[self.accepted[cause].candidate]
    }
}
