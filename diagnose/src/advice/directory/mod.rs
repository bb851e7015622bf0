//! The accepted causes as a torque model: a directory that `eval`, a control loop and `diagnose --model` take, so that one
//! diagnosis corrects the simulator (the patch) and the controller (this).
//!
//! The prediction of the last structural step of the ladder is a sum of columns. Inertial parameters go into
//! the rigid body, columns that are terms of the torque model become its terms, properties of the recording go
//! into the preprocessing. A tilted base and a torque gain are not linear in their parameters. They are stored
//! as tilt and gain, and the difference between the directory's prediction and that of the step is measured and
//! reported.

mod combination;
mod recorded;

use crate::error::DiagnoseError;
use crate::ladder::rungs::Free;
use crate::outcome::Outcome;
use crate::simulator::NominalModel;
use combination::Combination;
use datasets::Recording;
use datasets::metrics::Row;
use datasets::prepare::{Derivatives, Source};
use identify::base::BaseParameters;
use model::assemble::{Estimated, Parts};
use model::directory::metrics::{Metrics, SCHEMA};
use model::directory::{ModelFile, Preprocessing};
use model::predict::predict_noted;
use model::session::Session;
use ndarray::{Array1, Array2};
use physics::torque_model::TorqueModelRecord;
use recorded::Recorded;

/// A model directory in memory.
pub struct Directory {
    /// Contents of `model.json`: the torque model.
    pub file: ModelFile,
    /// Contents of `metrics.json`: its errors.
    pub metrics: Metrics,
    /// `compensator.safetensors`, where one was trained.
    pub compensator: Option<Vec<u8>>,
    /// Causes that a torque model cannot carry.
    pub left_out: Vec<String>,
    /// Root mean square difference between its prediction on the held-out recording and that of the ladder's
    /// last structural step, relative to the torque, on the joint where it is largest.
    pub departure: f64,
}

/// The torque model of the last structural step.
///
/// # Errors
/// Parameters that make no model, or recordings that no baseline can be fitted to.
pub fn directory(
    given: &NominalModel,
    data: &Recording,
    heldout: &Recording,
    outcome: &Outcome,
    cutoff_given: bool,
) -> Result<Directory, DiagnoseError> {
    let (found, frames) = (&outcome.findings, &outcome.frames);
    let structure = found.structure();
    let fit = found.refit(given, &frames.scale, &structure, Free::All);
    let recorded = Recorded::new(given, outcome, &fit);
    let mut sum = Combination::of(given, &frames.scale, &recorded.channel.zero);
    for (variable, v) in fit.variables.iter().enumerate() {
        if !recorded.holds(v.column) {
            sum.add_column(found.dictionary.column(v.column), variable);
        }
    }
    let (rigid, terms) = sum.values(fit.beta(), &fit.covariance());
    let robot = given
        .robot
        .clone()
        .with_gravity(recorded.gravity(&given.robot));
    let record = match given.file() {
        Some(file) => TorqueModelRecord {
            gravity: robot.gravity().into(),
            rigid,
            terms,
            ..file.physics.clone()
        },
        None => TorqueModelRecord::new(&robot, rigid, found.session.present.parameters(), terms),
    };
    let model = record.model()?;
    let preprocessing = preprocessing(outcome, &recorded, cutoff_given);
    let prepared = |recording: &Recording| {
        let done = preprocessing.prepare(recording, None);
        done.map_err(|error| DiagnoseError::Prepare {
            source_name: recording.source.clone(),
            error,
        })
    };
    let parts = [data, heldout].map(prepared);
    let session = Session::new(parts.into_iter().collect::<Result<_, _>>()?, &[]);
    let physics = predict_noted(&model, &session, &[], preprocessing.channel.as_ref());
    let base = BaseParameters::of_robot(&robot, &[]);
    let covariance = sum.covariance(&base, &fit.covariance());
    let values = base.base_from(&record.rigid);
    let std: Vec<f64> = covariance
        .diag()
        .iter()
        .map(|v| v.max(0.0).sqrt())
        .collect();
    let mut file = Parts {
        robot: &robot,
        data: std::slice::from_ref(data),
        session: &session,
        physics: &physics,
        record,
        base: Estimated {
            values: &values,
            std: &std[..base.len()],
        },
        covariance: &covariance,
        preprocessing,
        diagnostics: None,
        seed: 0,
        folds: found.grams.folds.len(),
    }
    .assemble(&model)?;
    let compensator = match &outcome.learned {
        Some(learned) => Some(learned.store(&mut file, &session, &model)?),
        None => None,
    };
    let metrics = metrics(&file, &session, &physics, outcome, [data, heldout])?;
    Ok(Directory {
        departure: departure(outcome, &physics[1]),
        left_out: recorded.left_out,
        metrics,
        compensator,
        file,
    })
}

/// Preparation of recordings for the model: that of the diagnosis.
fn preprocessing(outcome: &Outcome, recorded: &Recorded, cutoff_given: bool) -> Preprocessing {
    let (frames, report) = (&outcome.frames, outcome.frames.data.report());
    Preprocessing {
        rate_hz: report.rate_hz,
        fine_hz: report.fine_hz,
        cutoff_hz: report.cutoff_hz,
        cutoff_given,
        cutoff: frames.cutoff.clone(),
        position_alone: frames.options.derivatives == Derivatives::FromPosition,
        recorded_velocity: report.velocity.iter().all(|v| *v == Source::Recorded),
        torque_filter: report.torque_filter,
        torque_delay: recorded.delay,
        channel: recorded.named(),
        moving_only: false,
    }
}

/// Scores of the physics and the linear baseline on both recordings.
fn metrics(
    file: &ModelFile,
    session: &Session,
    physics: &[Array2<f64>],
    outcome: &Outcome,
    recordings: [&Recording; 2],
) -> Result<Metrics, DiagnoseError> {
    let mut rows: Vec<Vec<Row>> = Vec::new();
    for (part, recording) in recordings.into_iter().enumerate() {
        let motion = &session.parts[part].at_samples;
        let (q, qd, qdd) = (motion.q.view(), motion.qd.view(), motion.qdd.view());
        let linear = file.linear_baseline.predict(q, qd, qdd)?;
        let mut own = Vec::new();
        if let Some(tau) = &recording.tau {
            own.extend(Row::both_scopes(
                "linear_baseline",
                tau,
                &linear,
                &motion.qd,
            )?);
            own.extend(Row::both_scopes(
                "physics",
                tau,
                &physics[part],
                &motion.qd,
            )?);
            if let Some(learned) = outcome.learned.as_ref().filter(|_| part == 1) {
                let whole = &physics[part] + &learned.torque;
                own.extend(Row::both_scopes(
                    "physics+compensator",
                    tau,
                    &whole,
                    &motion.qd,
                )?);
            }
        }
        rows.push(own);
    }
    let heldout = rows.pop();
    Ok(Metrics {
        schema: SCHEMA,
        joints: file.joints.clone(),
        train: rows.pop().unwrap_or_default(),
        heldout,
        base_parameters: file.base_parameters.clone(),
        diagnostics: None,
        members: Vec::new(),
    })
}

/// Largest relative difference over the joints between the held-out prediction and that of the ladder's last structural step.
fn departure(outcome: &Outcome, physics: &Array2<f64>) -> f64 {
    let (tau, left) = (&outcome.frames.heldout.tau, &outcome.explanation.residual);
    let rms = |x: &Array1<f64>| (x.dot(x) / x.len().max(1) as f64).sqrt();
    let joints = (0..tau.ncols()).filter(|&j| left.column(j).iter().any(|x| *x != 0.0));
    joints
        .map(|j| {
            let step = &tau.column(j) - &left.column(j);
            let own = physics.column(j).to_owned();
            rms(&(&own - &step)) / rms(&step).max(f64::MIN_POSITIVE)
        })
        .fold(0.0, f64::max)
}
