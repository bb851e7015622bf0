//! Payload: a body on the last link, from a recording with it and a stored model without it.
//!
//! The recorded torque minus the stored model's is the body's torque, plus an error of the stored model, plus
//! noise. The body's torque is Y_b(q, q̇, q̈)·p with its ten standard parameters p in the last joint's frame.
//! The model's error is not neglected: its own parameters stay unknowns with the stored covariance as prior,
//! friction may have changed since, and the body's torque may pass a loaded gear with another gain and more
//! loss. Each joint's torque may also have an error over its position and direction, as large as the correlated
//! residual of the first pass (a discrepancy in the sense of Kennedy and O'Hagan, "Bayesian calibration of
//! computer models", J. R. Stat. Soc. B 63(3), 2001). With C the model's sensitivities, z ~ N(0, Σ), the
//! estimate minimises ‖Y_b p + C z − r‖² in units of the noise plus zᵀ Σ⁻¹ z, so that its standard deviations
//! include both.

mod body;
pub mod gains;
mod misfit;
mod noise;
mod size;
mod system;

pub use body::{Body, Figure};

use crate::directory::ModelFile;
use crate::evaluation::EvaluateError;
use crate::predict::predict_noted;
use crate::preparation::units::{Degrees, refuse_degrees};
use crate::session::Session;
use ::identify::feasible::FeasibilityError;
use ::identify::least_squares::LeastSquaresError;
use datasets::Recording;
use datasets::prepare::PrepareError;
use ndarray::Array2;
use physics::robot::PARAMETERS_PER_LINK;
use physics::torque_model::TorqueModelError;
use serde::Serialize;
use size::Size;
use system::System;

/// Settings of [`estimate`].
#[derive(Clone, Debug, PartialEq)]
pub struct PayloadOptions {
    /// Cut-off of the motion's low-pass, Hz, in place of the model's own.
    pub cutoff_hz: Option<f64>,
    /// Prior deviation of each coefficient of friction since the model was made, relative to its size. Default
    /// 0.1: a few degrees of a gear's temperature.
    pub friction_change: f64,
}

impl Default for PayloadOptions {
    fn default() -> Self {
        Self {
            cutoff_hz: None,
            friction_change: 0.1,
        }
    }
}

/// Estimated payload: a body on the last link.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Payload {
    /// Name and version of the format: `payload/1`.
    pub schema: &'static str,
    /// Names of the robot's joints, base first.
    pub joints: Vec<String>,
    /// Name of the joint in whose frame the parameters are.
    pub frame: String,
    /// Number of samples of the recording.
    pub samples: usize,
    /// Parameters of the payload's body.
    #[serde(flatten)]
    pub body: Body,
    /// Root mean square residual of the model without the body, by joint, N·m (N).
    pub rmse_without: Vec<f64>,
    /// Root mean square residual of the model with the body, by joint, N·m (N).
    pub rmse_with: Vec<f64>,
    /// Conditions of the figures, as text.
    pub notes: Vec<String>,
}

/// Reason why no body could be estimated.
#[derive(Debug, thiserror::Error)]
pub enum PayloadError {
    /// Recording and model that do not fit together.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// Recording without torque.
    #[error("{0} holds no torque (tau1 …), which the payload is told from")]
    NoTorque(String),
    /// Recording in which no torque depends on the body.
    #[error("{0}: no torque of this motion depends on the payload's mass or its moments")]
    Nothing(String),
    /// Recordings that determine no joint's gain well enough.
    #[error(
        "{file}: no joint's gain is told to {percent:.0} %: the known body's torque is too small beside what the model leaves"
    )]
    NoGain {
        /// Path of the recording with the body.
        file: String,
        /// Standard deviation that is required of a gain, %.
        percent: f64,
    },
    /// Failed least-squares problem.
    #[error(transparent)]
    LeastSquares(#[from] LeastSquaresError),
    /// Failed search for possible links.
    #[error(transparent)]
    Feasibility(#[from] FeasibilityError),
}

impl From<TorqueModelError> for PayloadError {
    fn from(error: TorqueModelError) -> Self {
        Self::Evaluate(error.into())
    }
}

impl From<Degrees> for PayloadError {
    fn from(error: Degrees) -> Self {
        Self::Evaluate(error.into())
    }
}

/// Number of passes: each takes the noise from the residual of the one before, and the load of load-dependent
/// friction from its body.
const PASSES: usize = 4;

/// Estimates the body on the last link from a recording and the stored model without it.
///
/// # Errors
/// See [`PayloadError`].
pub fn estimate(
    file: &ModelFile,
    recording: &Recording,
    options: &PayloadOptions,
) -> Result<Payload, PayloadError> {
    refuse_joints(file, recording)?;
    let tau = recording
        .tau
        .as_ref()
        .ok_or_else(|| PayloadError::NoTorque(recording.source.clone()))?;
    refuse_degrees(&file.physics.nominal()?, recording)?;
    let prepared = file
        .preprocessing
        .prepare(recording, options.cutoff_hz)
        .map_err(|source: PrepareError| {
            PayloadError::Evaluate(EvaluateError::Prepare {
                file: recording.source.clone(),
                source,
            })
        })?;
    let session = Session::new(vec![prepared], &file.clock);
    let model = file.physics.model()?;
    let mut system = System::new(file, &model, &session, options.friction_change);
    if !system.sees_anything() {
        return Err(PayloadError::Nothing(recording.source.clone()));
    }
    let size = Size::of(model.robot());
    let without = left(file, &session, tau, None)?;
    let mut residual = without.clone();
    let mut known: Option<[f64; PARAMETERS_PER_LINK]> = None;
    let mut body = None;
    for _ in 0..PASSES {
        // Of what the stored model with the body leaves, not of what the fit leaves: its many unknowns take up what is slow.
        let scale = noise::scale(&residual, &session, recording);
        let target = match &known {
            // The model carries the body already: what its load changes in friction is taken off with it.
            Some(parameters) => &residual + &system.torque(parameters),
            None => residual.clone(),
        };
        let (triangle, blocks) = system.rows(&target, &scale)?;
        let found = body::settle(&triangle, &blocks, &size)?;
        residual = left(file, &session, tau, Some(&found.parameters))?;
        system.allow(&found.parameters);
        if known.is_none() {
            let rest = system.left(&target, &found.unknowns);
            system.misfit(&noise::shared(&rest, &recording.starts()));
        }
        known = Some(found.parameters);
        body = Some(found.body);
    }
    let Some(body) = body else {
        unreachable!("there is at least one pass")
    };
    let frame = file.joints.last().cloned().unwrap_or_default();
    Ok(Payload {
        schema: "payload/1",
        joints: file.joints.clone(),
        samples: recording.len(),
        notes: notes(&body, &frame),
        frame,
        body,
        rmse_without: rms(&without),
        rmse_with: rms(&residual),
    })
}

/// Refuses a recording with another number of joints than the model.
fn refuse_joints(file: &ModelFile, recording: &Recording) -> Result<(), PayloadError> {
    if recording.dof() == file.joints.len() {
        return Ok(());
    }
    Err(PayloadError::Evaluate(EvaluateError::Joints {
        found: recording.dof(),
        file: recording.source.clone(),
        expected: file.joints.len(),
        robot: file.physics.robot.clone(),
    }))
}

/// Recorded torque minus that of the model, with the body on its last link where one is given, N·m (N), shape (samples, joints).
fn left(
    file: &ModelFile,
    session: &Session,
    tau: &Array2<f64>,
    body: Option<&[f64; PARAMETERS_PER_LINK]>,
) -> Result<Array2<f64>, PayloadError> {
    let mut physics = file.physics.clone();
    if let Some(body) = body {
        let first = PARAMETERS_PER_LINK * (file.joints.len() - 1);
        for parameters in [&mut physics.rigid, &mut physics.load] {
            for (p, b) in parameters[first..].iter_mut().zip(body) {
                *p += b;
            }
        }
    }
    let model = physics.model()?;
    let channel = file.preprocessing.channel.as_ref();
    let predicted = predict_noted(&model, session, &file.memory, channel);
    Ok(tau - &predicted[0])
}

/// Root mean square of each column.
fn rms(table: &Array2<f64>) -> Vec<f64> {
    let of = |column: ndarray::ArrayView1<f64>| {
        (column.dot(&column) / column.len().max(1) as f64).sqrt()
    };
    table.columns().into_iter().map(of).collect()
}

/// Conditions of the figures, as text.
fn notes(body: &Body, frame: &str) -> Vec<String> {
    let mut notes = vec![
        format!(
            "Centre of mass and inertia in the frame of {frame}; masses in the scale of the recorded torque: a torque constant \
             that is wrong by one percent is one percent of the mass."
        ),
        "Deviations hold noise that is correlated in time, the stored model's covariance, friction that has changed since, and \
         gears that pass on two percent more or less of the body's torque."
            .into(),
    ];
    if body.inertia.iter().any(Option::is_none) {
        notes.push(
            "This motion does not tell the whole inertia: four parameters are claimed, and the inertia is taken as that of a body of \
             plausible size, whose uncertainty is in the deviations."
                .into(),
        );
    }
    if body.mass.is_none() {
        notes.push("No torque of this motion tells the mass itself.".into());
    }
    if body.possible == Some(false) {
        notes.push(
            "No body has exactly these ten parameters; within their deviations one may.".into(),
        );
    }
    notes
}
