//! The simulator's model, to which the gap is measured.

mod identified;
pub(crate) mod possible;
mod replay;

pub use replay::Replay;

use crate::error::DiagnoseError;
use crate::motion::frame::Frame;
use crate::motion::passage::Terms;
use crate::motion::scene::{Scale, Scene};
use datasets::{PrepareOptions, Recording, prepare};
use identified::{Identified, IdentifiedFile};
use model::directory::ModelFile;
use model::preparation::cutoff;
use ndarray::Array2;
use physics::robot::{Joint, Masses, PARAMETERS_PER_LINK, Robot, RobotError};
use std::sync::Arc;

/// Model with which the simulator computes torque: a robot with its friction, or an identified model.
#[derive(Clone, Debug)]
pub struct NominalModel {
    /// Robot with inertials, damping, friction, rotor inertia, counterbalance and springs.
    pub robot: Robot,
    identified: Option<Identified>,
    preparation: Option<PrepareOptions>,
    replay: Option<Arc<Replay>>,
}

impl NominalModel {
    /// A robot exactly as the simulator has it.
    pub fn new(robot: Robot) -> Self {
        Self {
            robot,
            identified: None,
            preparation: None,
            replay: None,
        }
    }

    /// The physics of a model directory.
    ///
    /// # Errors
    /// A stored model whose parts do not fit together.
    pub fn identified(file: &ModelFile) -> Result<Self, DiagnoseError> {
        let (robot, identified) = Identified::new(file)?;
        Ok(Self {
            robot,
            identified: Some(identified),
            preparation: Some(file.preprocessing.options(None)),
            replay: None,
        })
    }

    /// The model with its residual on the recordings that it was identified from, for later recordings that repeat their motions.
    pub fn with_replay(self, replay: Replay) -> Self {
        Self {
            replay: Some(Arc::new(replay)),
            ..self
        }
    }

    /// The model on the clock of recordings of another day, by their motion alone. A model that was not identified has no memory.
    ///
    /// # Errors
    /// A recording that cannot be prepared.
    pub fn on_clock_of(mut self, recordings: &[&Recording]) -> Result<Self, DiagnoseError> {
        if let (Some(identified), Some(options)) = (&mut self.identified, &self.preparation) {
            let one = |recording: &&Recording| {
                prepare(recording, &cutoff::for_recording(options, recording)).map_err(|error| {
                    DiagnoseError::Prepare {
                        source_name: recording.source.clone(),
                        error,
                    }
                })
            };
            identified.on_clock_of(recordings.iter().map(one).collect::<Result<_, _>>()?);
        }
        Ok(self)
    }

    /// The earlier residuals that the model replays, where it does.
    pub fn replay(&self) -> Option<&Replay> {
        self.replay.as_deref()
    }

    /// The model without replayed residuals.
    pub fn alone(self) -> Self {
        Self {
            replay: None,
            ..self
        }
    }

    /// Robot whose masses and lengths give the size of each parameter. Identified parameters are combinations,
    /// and may be zero or negative where the nominal ones are not.
    pub fn sizes(&self) -> &Robot {
        self.identified.as_ref().map_or(&self.robot, |i| &i.sizes)
    }

    /// Whether its masses are given: described as such, or identified.
    pub fn has_masses(&self) -> bool {
        self.is_identified() || self.robot.masses() == Masses::Described
    }

    /// Preparation of the recordings on which the parameters were identified; none for a model that was not identified.
    pub fn preparation(&self) -> Option<&PrepareOptions> {
        self.preparation.as_ref()
    }

    /// Terms of an identified model that [`NominalModel::robot`] does not hold, by joint; empty for a model
    /// that was not identified.
    pub fn beside(&self) -> Vec<Terms> {
        self.identified.as_ref().map_or(Vec::new(), |i| i.beside())
    }

    /// Contents of the model file, where the model comes from one.
    pub(crate) fn file(&self) -> Option<&IdentifiedFile> {
        self.identified.as_ref().map(|i| &i.file)
    }

    /// Whether the parameters were identified on a recording. Then a parameter at zero does not count as missing.
    pub fn is_identified(&self) -> bool {
        self.identified.is_some()
    }

    /// Torque that the simulator predicts at the recorded samples, N·m (N), shape (samples, joints): inverse
    /// dynamics + damping·q̇ + friction·sign(q̇), with rotor inertia, counterbalance and springs where the
    /// model has them. For an identified model its torque with memory, plus the replayed residual of an earlier
    /// recording.
    pub fn predicted(&self, frame: &Frame, scale: &Scale) -> Array2<f64> {
        let torque = match &self.identified {
            Some(identified) => identified.predicted(frame),
            None => {
                frame.table_to_samples(&Scene::new(&self.robot, frame.motion(), scale).predicted())
            }
        };
        match &self.replay {
            Some(replay) => torque + replay.at(frame),
            None => torque,
        }
    }

    /// The model's robot with parameters moved by `change` (10 N inertial, N viscous, N Coulomb). Coefficients
    /// of friction stay at zero or above: a direction of friction that feeds energy is a fit's artefact.
    ///
    /// # Errors
    /// Wrong number of values.
    pub fn moved(&self, change: &[f64]) -> Result<Robot, RobotError> {
        let n = self.robot.dof();
        let (inertial, friction) = change.split_at(PARAMETERS_PER_LINK * n);
        let parameters: Vec<f64> = self
            .robot
            .parameters()
            .iter()
            .zip(inertial)
            .map(|(p, d)| p + d)
            .collect();
        let joints = self.robot.joints();
        let damping: Vec<f64> = joints
            .iter()
            .zip(friction)
            .map(|(j, d)| (j.damping + d).max(0.0))
            .collect();
        let coulomb: Vec<f64> = joints
            .iter()
            .zip(&friction[n..])
            .map(|(j, d)| (j.friction + d).max(0.0))
            .collect();
        self.robot
            .with_parameters(&parameters)?
            .with_friction(&damping, &coulomb)
    }
}

/// Size of each inertial parameter of a link: its mass, times its radius of gyration about the joint, times that again.
pub(crate) fn link_sizes(joint: &Joint) -> [f64; PARAMETERS_PER_LINK] {
    let body = &joint.link.inertia;
    let spread = body.about_com().trace() / 2.0 / body.mass.max(1e-9);
    let radius = (body.com().norm_squared() + spread).sqrt().max(1e-3);
    let (m, h, i) = (body.mass, body.mass * radius, body.mass * radius * radius);
    [m, h, h, h, i, i, i, i, i, i]
}
