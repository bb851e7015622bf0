//! Errors of a diagnosis.

use datasets::ReadError;
use datasets::metrics::ShapeError;
use datasets::prepare::PrepareError;
use datasets::write::WriteProblem;
use model::baseline::BaselineError;
use model::directory::DirectoryError;
use model::physics_fit::FitError;
use model::preparation::cutoff::CutoffError;
use model::preparation::setup::SetupError;
use model::residual::ResidualError;
use physics::robot::RobotError;
use physics::torque_model::TorqueModelError;

/// Reason why a diagnosis cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum DiagnoseError {
    /// The robot's description is refused.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// The robot's description or its drive file is refused.
    #[error(transparent)]
    Setup(Box<SetupError>),
    /// A model directory is refused.
    #[error(transparent)]
    Directory(Box<DirectoryError>),
    /// A stored model does not fit together.
    #[error(transparent)]
    Model(#[from] TorqueModelError),
    /// Recording that cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A recording cannot be prepared.
    #[error("{source_name}: {error}")]
    Prepare {
        /// Name of the recording that cannot be prepared.
        source_name: String,
        /// Reason why it cannot be prepared.
        error: PrepareError,
    },
    /// Recording for which no cut-off can be chosen.
    #[error(transparent)]
    Cutoff(Box<CutoffError>),
    /// A recording without torque.
    #[error("{0}: no measured torque (columns tau1, tau2, …): a gap cannot be measured without it")]
    NoTorque(String),
    /// Recordings to be joined that were filtered differently.
    #[error(
        "{other}: its torque has been through another low-pass than that of {one}, and one diagnosis takes them as one recording"
    )]
    Filters {
        /// Name of the first recording.
        one: String,
        /// Name of the recording that was filtered differently.
        other: String,
    },
    /// Earlier recordings from which nothing can be identified.
    #[error(transparent)]
    Before(Box<FitError>),
    /// Failed training of the compensator on the residual.
    #[error("the compensator cannot be trained on what is left: {0}")]
    Learn(#[from] ResidualError),
    /// Failed design of a motion.
    #[error("no experiment can be designed: {0}")]
    Experiment(#[from] identify::excitation::ExcitationError),
    /// The linear baseline of a model directory.
    #[error(transparent)]
    Baseline(#[from] BaselineError),
    /// Tables of different shapes.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A patched description that does not reproduce the causes found.
    #[error("{0}; nothing was written: report the description to the authors")]
    Patch(String),
    /// A result cannot be written.
    #[error(transparent)]
    Write(#[from] report::WriteError),
    /// A report that cannot be written, found before the diagnosis.
    #[error(transparent)]
    Output(#[from] report::write::OutputError),
    /// A motion cannot be written.
    #[error(transparent)]
    Motion(#[from] datasets::WriteError),
}

impl From<SetupError> for DiagnoseError {
    fn from(error: SetupError) -> Self {
        Self::Setup(Box::new(error))
    }
}

impl From<DirectoryError> for DiagnoseError {
    fn from(error: DirectoryError) -> Self {
        Self::Directory(Box::new(error))
    }
}

impl From<FitError> for DiagnoseError {
    fn from(error: FitError) -> Self {
        Self::Before(Box::new(error))
    }
}

impl From<CutoffError> for DiagnoseError {
    fn from(error: CutoffError) -> Self {
        Self::Cutoff(Box::new(error))
    }
}

impl DiagnoseError {
    /// Advice for the user, where the message does not give it.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Prepare { error, .. } => Some(error.advice()).filter(|text| !text.is_empty()),
            Self::Filters { .. } => Some("Diagnose them one at a time."),
            Self::Learn(ResidualError::Compensator(compensator::Error::Networks)) => {
                Some("Leave --learn out, or build the programs whole: cargo build --release.")
            }
            _ => None,
        }
    }

    /// Whether the input is at fault (exit status 2) rather than the machine (1).
    pub fn is_input(&self) -> bool {
        match self {
            DiagnoseError::Learn(ResidualError::Compensator(compensator::Error::Networks)) => true,
            DiagnoseError::Write(_) | DiagnoseError::Learn(_) | DiagnoseError::Patch(_) => false,
            DiagnoseError::Motion(e) => matches!(
                e.problem,
                WriteProblem::UnknownFormat(_) | WriteProblem::NoCurves(_)
            ),
            DiagnoseError::Directory(e) => !matches!(
                **e,
                DirectoryError::Write(_) | DirectoryError::Folder { .. }
            ),
            _ => true,
        }
    }
}
