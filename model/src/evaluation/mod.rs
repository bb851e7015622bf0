//! `eval`: scores and predictions of a model directory on a recording.

mod error;
mod form;
mod misfit;
mod share;
mod variants;
mod worth;

pub use error::EvaluateError;
pub use form::{Formed, GROWTH, form};
pub use share::Share;

use crate::baseline::published::Published;
use crate::directory::ModelFile;
use crate::inversion::{Inversion, PHYSICS_FORWARD};
use crate::loaded::Loaded;
use crate::page::Subject;
use crate::predict::parameter_deviation;
use crate::preparation::setup::{self, Setup, SetupError};
use crate::preparation::units::refuse_degrees;
use crate::residual::{self};
use crate::session::Session;
use crate::spread::Coverage;
use datasets::metrics::{MOVING, Row, Scope, Scores, deviations};
use datasets::prepare::PrepareReport;
use datasets::repeats::{self, Repeatability};
use datasets::{Part, Recording, Trajectory};
use ndarray::Array2;
use physics::torque_model::TorqueModelError;
use serde::Serialize;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Settings of [`evaluate`].
#[derive(Clone, Debug, Default)]
pub struct EvaluateOptions {
    /// Cut-off of the motion's low-pass, Hz, in place of the model's own.
    pub cutoff_hz: Option<f64>,
}

/// Contents of `eval --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EvalReport {
    /// Name and version of the format: `eval/1`.
    pub schema: &'static str,
    /// Names of the robot's joints, base first.
    pub joints: Vec<String>,
    /// Number of samples of the recording.
    pub samples: usize,
    /// Scores of each model and scope.
    pub rows: Vec<Row>,
    /// Repeatability: spread of repeated motions, where the recording has some. It is the noise floor in motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeatability: Option<Repeatability>,
    /// Share of (physics² − repeatability²) that the compensator removes over all samples, where motions repeat.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share_of_repeatable: Option<Share>,
    /// Coverage: part of the recorded torque within the stated 90 % intervals; none without torque.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coverage: Option<Coverage>,
    /// Conditions of the figures, as text.
    pub notes: Vec<String>,
}

/// Scored recording with all intermediate results.
pub struct Evaluation {
    /// Report with the scores and notes.
    pub report: EvalReport,
    /// Recording that was evaluated.
    pub recording: Recording,
    /// Motion of the recording at the recorded samples.
    pub session: Session,
    /// Torque of the whole model, N·m (N), shape (samples, joints).
    pub torque: Array2<f64>,
    /// Torque of the physics alone, N·m (N), shape (samples, joints).
    pub physics: Array2<f64>,
    /// Standard deviation of `torque`, N·m (N), shape (samples, joints).
    pub deviation: Array2<f64>,
    /// Positions from torque alone, rad (m), shape (samples, joints). None unless `train forward` was run and
    /// the recording has its rate.
    pub positions: Option<Array2<f64>>,
}

/// Options for reading recordings of a stored model's robot.
///
/// # Errors
/// A drive file that does not fit the robot.
pub fn read_options(
    file: &ModelFile,
    drive: Option<&Path>,
    part: Part,
    torque_needed: bool,
) -> Result<datasets::ReadOptions, SetupError> {
    let robot = file.physics.nominal().map_err(|e| match e {
        TorqueModelError::Robot(e) => SetupError::Robot(e),
        // Only the URDF is parsed here.
        e => unreachable!("{e}"),
    })?;
    let mut options = Setup::of(robot, drive)?.read_options(part, torque_needed)?;
    let stored = file.preprocessing.torque_filter;
    options.stored_model = true;
    options.torque_filter = options
        .torque_filter
        .or(stored.map(|filter| setup::known(filter, file.preprocessing.rate_hz)));
    Ok(options)
}

/// Scores a model on a recording; a recording without torque gets predictions and no rows.
///
/// # Errors
/// See [`EvaluateError`].
pub fn evaluate(
    directory: &Path,
    file: &ModelFile,
    recording: Recording,
    options: &EvaluateOptions,
) -> Result<Evaluation, EvaluateError> {
    if recording.dof() != file.joints.len() {
        return Err(EvaluateError::Joints {
            found: recording.dof(),
            file: recording.source,
            expected: file.joints.len(),
            robot: file.physics.robot.clone(),
        });
    }
    refuse_degrees(&file.physics.nominal()?, &recording)?;
    let prepared = file
        .preprocessing
        .prepare(&recording, options.cutoff_hz)
        .map_err(|source| EvaluateError::Prepare {
            file: recording.source.clone(),
            source,
        })?;
    let channel = file.preprocessing.channel.as_ref();
    let session = Session::new(vec![prepared], &file.clock);
    let model = file.physics.model()?;
    let compensator = residual::load(directory, file)?;
    let loaded = Loaded {
        file,
        model: &model,
        compensator: compensator.as_ref(),
    };
    let [physics, torque] = loaded.torque(&session)?;
    let mut deviation =
        parameter_deviation(&model, &session, &file.memory, &file.covariance_table());
    let motion = &session.parts[0].at_samples;
    for ((row, joint), sigma) in deviation.indexed_iter_mut() {
        let regime = if motion.qd[[row, joint]].abs() > MOVING {
            &file.residual_std.moving
        } else {
            &file.residual_std.standstill
        };
        let gain = channel.map_or(1.0, |c| c.gain[joint]);
        *sigma = (gain * *sigma).hypot(regime[joint]);
    }
    let mut rows = Vec::new();
    if let Some(tau) = &recording.tau {
        let linear =
            file.linear_baseline
                .predict(motion.q.view(), motion.qd.view(), motion.qdd.view())?;
        rows.extend(Row::both_scopes(
            "linear_baseline",
            tau,
            &linear,
            &motion.qd,
        )?);
        rows.extend(Row::both_scopes("physics", tau, &physics, &motion.qd)?);
        if file.compensator.is_some() {
            rows.extend(Row::both_scopes(
                "physics+compensator",
                tau,
                &torque,
                &motion.qd,
            )?);
        }
    }
    let (more, of_variants) =
        variants::rows(&loaded, &recording, &session.parts[0], options.cutoff_hz)?;
    rows.extend(more);
    if let Some(forward) = &file.forward_baseline {
        rows.extend(forward.rows(&recording, &motion.qd)?.into_iter().flatten());
    }
    let inversion = Inversion::load(directory, file.joints.len())?;
    let fits = |i: &Inversion| recording.tau.is_some() && i.prior.covers(&recording);
    let positions = inversion
        .filter(fits)
        .map(|i| i.positions(&loaded, &recording, &AtomicBool::new(false)))
        .transpose()?;
    if let Some(q) = &positions {
        rows.extend(Row::both_scopes(
            PHYSICS_FORWARD,
            &recording.q,
            q,
            &motion.qd,
        )?);
    }
    let mut notes = notes(&session, 0, file);
    if let Some(name) = file.provenance.fitted(&recording) {
        notes.insert(0, format!("The model was fitted on rows of this recording ({name}): its scores say nothing about other motions."));
    }
    if positions.is_some() {
        notes.push(format!("{PHYSICS_FORWARD}: positions from the recorded torque and the first position of each trajectory, by solving the model for the motion (train forward); every position has seen the torque of its whole trajectory. Its figures are about positions, RMSE in rad (m)."));
    }
    notes.extend(of_variants);
    let repeatability = repeats::repeatability(&recording, &motion.qd, &repeats::find(&recording));
    let score = |name: &str| {
        let of_all = rows
            .iter()
            .find(|r| r.name == name && r.scope == Scope::All);
        of_all.map(|r| &r.scores)
    };
    let share_of_repeatable = repeatability.as_ref().and_then(|repeated| {
        let tau = recording.tau.as_ref()?;
        let deviations = deviations(tau.view(), motion.qd.view());
        let floor = Scores::relative(
            repeated.all.iter().copied().map(Some).collect(),
            &deviations,
        );
        let (physics, whole) = (score("physics")?, score("physics+compensator")?);
        Some(Share::of(physics, whole, &floor))
    });
    let report = EvalReport {
        share_of_repeatable,
        coverage: recording.tau.as_ref().map(|tau| {
            let errors = tau - &torque;
            Coverage::of(errors.view(), deviation.view(), motion.qd.view())
        }),
        schema: "eval/1",
        joints: file.joints.clone(),
        samples: recording.len(),
        rows,
        repeatability,
        notes,
    };
    let mut evaluation = Evaluation {
        report,
        recording,
        session,
        torque,
        physics,
        deviation,
        positions,
    };
    if let Some(warning) = evaluation.misfit(file) {
        evaluation.report.notes.insert(0, warning);
    }
    Ok(evaluation)
}

impl Evaluation {
    /// Writes predicted torque and its standard deviation as CSV: `trajectory,time,tau1…,tau1_std…`.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_prediction(&self, path: &Path) -> Result<(), report::WriteError> {
        use std::fmt::Write;
        let joints = self.torque.ncols();
        let mut text = String::from("trajectory,time");
        for suffix in ["", "_std"] {
            for joint in 1..=joints {
                let _ = write!(text, ",tau{joint}{suffix}");
            }
        }
        text.push('\n');
        for Trajectory { label, range } in &self.recording.trajectories {
            let label = if label.contains([',', '"', '\n', '\r']) {
                format!("\"{}\"", label.replace('"', "\"\""))
            } else {
                label.clone()
            };
            for row in range.clone() {
                let _ = write!(text, "{label},{}", self.recording.time[row]);
                for value in self.torque.row(row).iter().chain(self.deviation.row(row)) {
                    let _ = write!(text, ",{value}");
                }
                text.push('\n');
            }
        }
        report::write_atomic(path, &text)
    }

    /// Subject of the evaluation's page: recording, torque and scores.
    pub fn subject<'a>(&'a self, published: &'a [&'static Published]) -> Subject<'a> {
        Subject {
            recording: &self.recording,
            motion: &self.session.parts[0].at_samples,
            torque: &self.torque,
            rows: &self.report.rows,
            notes: &self.report.notes,
            published,
        }
    }
}

/// Origin of a cut-off as text.
fn cutoff_words(report: &PrepareReport, file: &ModelFile) -> String {
    let own = &file.preprocessing;
    match (own.cutoff_hz, report.cutoff_hz) {
        (Some(model), Some(hz)) if hz < model => {
            format!("the highest that this rate carries instead of the model's {model:.3} Hz")
        }
        (model, hz) if model != hz => "as given".to_owned(),
        _ if own.cutoff_given => "as given for the model".to_owned(),
        _ if own.cutoff.is_some() => "chosen by the torque's error on rows left out".to_owned(),
        _ => "chosen from the data".to_owned(),
    }
}

/// Conditions of the figures of one recording of the session, as text.
pub fn notes(session: &Session, part: usize, file: &ModelFile) -> Vec<String> {
    let report = &session.parts[part].report;
    let mut notes = Vec::new();
    match report.cutoff_hz {
        Some(hz) => notes.push(format!(
            "Motion: zero-phase low-pass at {hz:.3} Hz, {}; not causal.",
            cutoff_words(report, file)
        )),
        None => notes.push("Motion: splines through the recorded positions; not causal.".into()),
    }
    if let Some(f) = report.torque_filter {
        notes.push(format!(
            "The recorded torque has been low-passed (zero-phase Chebyshev, order {}, {:.3} Hz{}): the same filter was applied to every prediction before scoring.",
            f.order,
            f.cutoff_hz,
            if f.recognised {
                "; recognised from the empty stop band of the training torque, declare it in a drive file if you know better"
            } else {
                ""
            }
        ));
    }
    if !session.clock_known[part] {
        notes.push("The recording does not continue the clock of the training recordings: friction memory starts neutral and warm-up takes its mean.".into());
    }
    if file.preprocessing.channel.is_some() {
        notes.push("Scale, bias and limit of the recorded torque and joint zeros that the diagnosis found are applied to every prediction (model.json, preprocessing.channel); the control loop does without.".into());
    }
    notes.push(match &file.forward_baseline {
        Some(f) => format!(
            "forward_baseline: a linear state space of {} states simulates positions from the recorded torque, at {:.4} samples per second, from the mean position at the start of each trajectory; its figures are about positions, RMSE in rad (m). Faster recordings are thinned to that rate; one that does not thin to it has no such row.",
            f.model.system.order(),
            f.rate_hz
        ),
        None => "No forward_baseline: the training recordings are too short for it.".into(),
    });
    if file.preprocessing.moving_only {
        notes.push("The model was fitted on moving samples alone (--moving-only).".into());
    }
    notes
}
