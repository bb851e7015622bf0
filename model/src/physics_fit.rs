//! `train --physics-only`: from recordings to an identified model with its scores.

use crate::assemble::{Estimated, Parts};
use crate::baseline::BaselineError;
use crate::directory::{ModelFile, Preprocessing};
use crate::identify::diagnostics::{self, Conditioning, Diagnostics};
use crate::identify::error::IdentifyError;
use crate::identify::identification::{Identified, IdentifyOptions, identify};
use crate::identify::target::{self, Target};
use crate::predict::predict;
use crate::preparation::choice;
use crate::preparation::cutoff::{self, CutoffError};
use crate::session::Session;
use ::identify::base::BaseParameters;
use ::identify::feasible::Feasible;
use datasets::metrics::{Row, ShapeError};
use datasets::prepare::Source as Derivative;
use datasets::prepare::{Derivatives, PrepareError, PrepareOptions, prepare};
use datasets::{Folds, Recording};
use ndarray::Array2;
use physics::effects::Term;
use physics::robot::Robot;
use physics::torque_model::{TorqueModelRecord, WeightedTerm};

/// Settings of [`fit_physics`].
#[derive(Clone, Debug, Default)]
pub struct FitOptions {
    /// Settings of the identification.
    pub identify: IdentifyOptions,
    /// Preparation of the recordings.
    pub prepare: PrepareOptions,
    /// Random seed, for provenance.
    pub seed: u64,
}

impl FitOptions {
    /// Options as for `train --basic`: the rigid body with each joint's basic terms, without terms from the dictionary.
    pub fn basic() -> Self {
        let mut options = Self::default();
        options.identify.select = false;
        options
    }
}

/// Reason why a model could not be fitted.
#[derive(Debug, thiserror::Error)]
pub enum FitError {
    /// Cut-off of the motion that cannot be chosen.
    #[error(transparent)]
    Cutoff(#[from] CutoffError),
    /// Recording that cannot be prepared.
    #[error("{file}: {source}")]
    Prepare {
        /// Name of the recording that cannot be prepared.
        file: String,
        /// Reason why it cannot be prepared.
        source: PrepareError,
    },
    /// Failed identification of the physics.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    /// Linear baseline that cannot be fitted.
    #[error(transparent)]
    Baseline(#[from] BaselineError),
    /// Tables of different shapes.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// Stored model that does not fit together.
    #[error(transparent)]
    Model(#[from] physics::torque_model::TorqueModelError),
}

/// Fitted model of the physics with its intermediate results.
pub struct Fit {
    /// Fitted model as `model.json` holds it.
    pub file: ModelFile,
    /// Training recordings, then the held-out one where there is one.
    pub session: Session,
    /// Result of the identification.
    pub identified: Identified,
    /// Possible links nearest to the estimate, where some were found.
    pub possible: Option<Feasible>,
    /// Torque of the physics for every recording of the session, N·m (N), shape (samples, joints).
    pub physics: Vec<Array2<f64>>,
    /// Group of each training trajectory, per recording; a fold never splits a group.
    pub fold: Vec<Vec<usize>>,
}

/// Identifies `robot` from `data`. Of `heldout` only the motion is used, for memory.
///
/// # Errors
/// See [`FitError`].
pub fn fit_physics(
    robot: &Robot,
    data: &[Recording],
    heldout: Option<&Recording>,
    options: &FitOptions,
) -> Result<Fit, FitError> {
    let (options_chosen, cutoff, torque_delay) = choice::choose(robot, data, &options.prepare)?;
    let mut parts = Vec::new();
    for recording in data.iter().chain(heldout) {
        let own = cutoff::for_recording(&options_chosen, recording);
        parts.push(
            prepare(recording, &own).map_err(|source| FitError::Prepare {
                file: recording.source.clone(),
                source,
            })?,
        );
    }
    let session = Session::new(parts, &[]);
    let rest = data
        .iter()
        .zip(&session.parts)
        .map(|(recording, part)| target::identified(robot, recording, part))
        .collect::<Result<Vec<_>, IdentifyError>>()?;
    let recordings: Vec<&Recording> = data.iter().collect();
    let target = Target {
        tau: rest.iter().collect(),
        folds: Folds::new(
            &recordings,
            options.identify.folds,
            cutoff::gap(&options_chosen),
        ),
    };
    let identified = identify(robot, &session, &target, &options.identify)?;
    let record = record(robot, &identified);
    let model = record.model()?;
    let physics = predict(&model, &session, &[]);
    let base = BaseParameters::of_robot(robot, &[]);
    // The recording with most samples speaks for all.
    let first = (0..data.len())
        .max_by_key(|&i| (data[i].len(), std::cmp::Reverse(i)))
        .map_or(&session.parts[0].report, |i| &session.parts[i].report);
    let possible = diagnostics::possible(robot, &identified).ok();
    let diagnosed = diagnose(
        robot,
        &identified,
        possible.as_ref(),
        data,
        &session,
        &physics,
    )?;
    let preprocessing = Preprocessing {
        rate_hz: first.rate_hz,
        fine_hz: first.fine_hz,
        cutoff_hz: first.cutoff_hz,
        cutoff_given: options.prepare.cutoff_hz.is_some(),
        cutoff,
        position_alone: options_chosen.derivatives == Derivatives::FromPosition,
        recorded_velocity: first.velocity.iter().all(|v| *v == Derivative::Recorded),
        torque_filter: first.torque_filter,
        torque_delay,
        channel: None,
        moving_only: options.identify.moving_only,
    };
    let estimate = &identified.estimate;
    let file = Parts {
        robot,
        data,
        session: &session,
        physics: &physics,
        record,
        base: Estimated {
            values: &estimate.parameters[..base.len()],
            std: &estimate.std[..base.len()],
        },
        covariance: &estimate.covariance,
        preprocessing,
        diagnostics: Some(diagnosed),
        seed: options.seed,
        folds: identified.folds,
    }
    .assemble(&model)?;
    Ok(Fit {
        file,
        session,
        identified,
        possible,
        physics,
        fold: Folds::of_visits(&recordings, options.identify.folds).of_trajectories(&recordings),
    })
}

impl Fit {
    /// Scores of `linear_baseline`, `physics` and, where there is one, `forward_baseline` for one recording of the session.
    ///
    /// # Errors
    /// Tables of different shapes.
    pub fn rows(&self, part: usize, recording: &Recording) -> Result<Vec<Row>, FitError> {
        let Some(tau) = &recording.tau else {
            return Ok(Vec::new());
        };
        let motion = &self.session.parts[part].at_samples;
        let linear = self.file.linear_baseline.predict(
            motion.q.view(),
            motion.qd.view(),
            motion.qdd.view(),
        )?;
        let mut rows = Vec::new();
        rows.extend(Row::both_scopes(
            "linear_baseline",
            tau,
            &linear,
            &motion.qd,
        )?);
        rows.extend(Row::both_scopes(
            "physics",
            tau,
            &self.physics[part],
            &motion.qd,
        )?);
        if let Some(forward) = &self.file.forward_baseline {
            rows.extend(forward.rows(recording, &motion.qd)?.into_iter().flatten());
        }
        Ok(rows)
    }
}

/// Quality of an identification: conditioning, residual tests and possible links.
fn diagnose(
    robot: &Robot,
    identified: &Identified,
    possible: Option<&Feasible>,
    data: &[Recording],
    session: &Session,
    physics: &[Array2<f64>],
) -> Result<Diagnostics, IdentifyError> {
    let mut breaks = Vec::new();
    let mut first = 0;
    for recording in data {
        breaks.extend(recording.starts().iter().map(|start| first + start));
        first += recording.len();
    }
    let column = |table: &dyn Fn(usize) -> Vec<f64>| -> Vec<f64> {
        (0..data.len()).flat_map(table).collect()
    };
    let residual_tests = (0..robot.dof())
        .map(|j| {
            let tau = |part: usize| -> Vec<f64> {
                let tau = data[part].tau.as_ref();
                tau.map_or_else(Vec::new, |t| t.column(j).to_vec())
            };
            diagnostics::tests(
                &column(&tau),
                &column(&|part| physics[part].column(j).to_vec()),
                &column(&|part| session.parts[part].at_samples.qd.column(j).to_vec()),
                &breaks,
            )
        })
        .collect();
    Ok(Diagnostics {
        estimator: identified.report.clone(),
        conditioning: Conditioning::of(identified)?,
        poorly_determined: diagnostics::poorly_determined(identified),
        residual_tests,
        links: possible.map_or_else(Vec::new, |p| diagnostics::links(robot, &p.standard)),
        moved: possible.and_then(|p| diagnostics::moved(identified, p)),
        cost: possible
            .map(|p| diagnostics::cost(identified, p))
            .transpose()?,
    })
}

/// Record of the identified physics, for `model.json`.
fn record(robot: &Robot, identified: &Identified) -> TorqueModelRecord {
    let base = identified.base.len();
    let estimate = &identified.estimate;
    let mut terms: Vec<Vec<WeightedTerm>> = Vec::new();
    for (list, offset) in identified.terms.iter().zip(identified.term_offsets()) {
        terms.push(
            list.iter()
                .enumerate()
                .map(|(k, term)| WeightedTerm {
                    term: term.clone(),
                    value: estimate.parameters[offset + k],
                    std: estimate.std[offset + k],
                })
                .collect(),
        );
    }
    for p in robot.passive() {
        terms[p.joint()].push(WeightedTerm {
            term: Term::from(*p),
            value: 1.0,
            std: 0.0,
        });
    }
    TorqueModelRecord::new(
        robot,
        identified.base.standard_from(&estimate.parameters[..base]),
        identified.base.standard_from(&identified.load_base),
        terms,
    )
}
