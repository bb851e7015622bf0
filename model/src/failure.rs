//! Failure messages of the command lines.

use crate::directory::DirectoryError;
use crate::evaluation::EvaluateError;
use crate::identify::error::IdentifyError;
use crate::inversion::InversionError;
use crate::leaderboard::LeaderboardError;
use crate::payload::PayloadError;
use crate::physics_fit::FitError;
use crate::preparation::check::CheckError;
use crate::preparation::setup::SetupError;
use crate::residual::ResidualError;
use crate::sums::SumsError;
use physics::robot::RobotError;

/// Failure of a command: one line for the user, a hint, and the exit status.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// Message for the user, in one line.
    pub message: String,
    /// Advice for the user; empty where there is no advice.
    pub hint: String,
    /// Exit status: 2 where the input cannot be used, 130 where interrupted, 1 for all else.
    pub status: u8,
}

impl Failure {
    /// Failure by input that cannot be used, exit status 2.
    pub fn input(message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            hint: hint.into(),
            status: 2,
        }
    }

    /// Failure that is not the input's fault, exit status 1.
    pub fn other(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            hint: String::new(),
            status: 1,
        }
    }

    /// Interruption by the user, exit status 130.
    pub fn interrupted(hint: impl Into<String>) -> Self {
        Self {
            message: "interrupted".into(),
            hint: hint.into(),
            status: 130,
        }
    }

    /// Prints message and hint to standard error and returns the exit status.
    pub fn report(&self) -> std::process::ExitCode {
        report::warn!("error: {}", self.message);
        if !self.hint.is_empty() {
            report::warn!("hint: {}", self.hint);
        }
        std::process::ExitCode::from(self.status)
    }
}

impl From<SetupError> for Failure {
    fn from(error: SetupError) -> Self {
        match error {
            SetupError::Robot(e @ RobotError::UnknownRobot { .. }) => Self::input(
                e.to_string(),
                "See the built-in names (ur5, kr300, foxbot_a05, puma560), or give the path of a URDF or MJCF.",
            ),
            SetupError::Robot(_)
            | SetupError::Read(_)
            | SetupError::Degrees(_)
            | SetupError::NotHeldOut { .. } => Self::input(error.to_string(), ""),
        }
    }
}

impl From<FitError> for Failure {
    fn from(error: FitError) -> Self {
        let hint = match &error {
            FitError::Prepare { source, .. } => source.advice(),
            FitError::Identify(IdentifyError::NoTorque(_)) => {
                "Only eval --predict takes a recording without torque."
            }
            FitError::Identify(IdentifyError::NothingMoves) => {
                "Record motion of at least one joint; see train --check-only."
            }
            FitError::Identify(IdentifyError::Joints { .. }) => {
                "Give the robot that made the recording."
            }
            FitError::Baseline(_) => "Record more samples: three per joint are the least.",
            _ => return Self::other(error.to_string()),
        };
        Self::input(error.to_string(), hint)
    }
}

impl From<SumsError> for Failure {
    fn from(error: SumsError) -> Self {
        let hint = match error {
            SumsError::Fit(e) => return e.into(),
            SumsError::OtherRobot => {
                "Use one accumulator for each robot, of the same description on every machine."
            }
            SumsError::OtherPreparation { .. } => {
                "Give all workers the same cutoff_hz, or the empty copy of an accumulator that has its first recording."
            }
            SumsError::Broken(_) => {
                "Make it again from its recordings: it is cut, or of another version."
            }
        };
        Self::input(error.to_string(), hint)
    }
}

impl From<CheckError> for Failure {
    fn from(error: CheckError) -> Self {
        let hint = match &error {
            CheckError::Prepare { source, .. } => source.advice().into(),
            CheckError::Check { problem, .. } => problem.advice(),
            CheckError::LeastSquares { .. } => return Self::other(error.to_string()),
        };
        Self::input(error.to_string(), hint)
    }
}

impl From<DirectoryError> for Failure {
    fn from(error: DirectoryError) -> Self {
        match error {
            DirectoryError::Write(e) => Self::other(e.to_string()),
            e @ DirectoryError::Other { .. } => Self::input(
                e.to_string(),
                "Run train forward on this model again, or remove the file.",
            ),
            e => Self::input(
                e.to_string(),
                "Give a directory that train has written, whole and by this version.",
            ),
        }
    }
}

impl From<ResidualError> for Failure {
    fn from(error: ResidualError) -> Self {
        match error {
            ResidualError::Compensator(compensator::Error::Interrupted) => {
                Self::interrupted("Run the same command with --resume to go on.")
            }
            ResidualError::Compensator(
                e @ (compensator::Error::OtherCheckpoint { .. }
                | compensator::Error::CheckpointVersion { .. }
                | compensator::Error::BadCheckpoint { .. }),
            ) => Self::input(
                e.to_string(),
                "Nothing was changed. Run without --resume to start afresh.",
            ),
            ResidualError::Compensator(e @ compensator::Error::Gpu(_)) => Self::input(
                e.to_string(),
                "Leave --gpu out: the CPU trains the same networks. For a GPU: cargo build --release --manifest-path gpu/Cargo.toml.",
            ),
            ResidualError::Compensator(e @ compensator::Error::Networks) => Self::input(
                e.to_string(),
                "Build the programs whole: cargo build --release.",
            ),
            ResidualError::Compensator(e @ compensator::Error::Io { .. }) => {
                Self::other(e.to_string())
            }
            ResidualError::Compensator(e) => Self::input(
                e.to_string(),
                "See train --check-only, or train with --physics-only.",
            ),
            ResidualError::Folds => Self::input(
                error.to_string(),
                "Give more recordings or trajectories, or train without --yardsticks.",
            ),
            e => Self::input(
                e.to_string(),
                "Copy the whole model directory again, or train the model again.",
            ),
        }
    }
}

impl From<EvaluateError> for Failure {
    fn from(error: EvaluateError) -> Self {
        match error {
            EvaluateError::Directory(e) => e.into(),
            EvaluateError::Residual(e) => e.into(),
            EvaluateError::Inversion(e) => e.into(),
            EvaluateError::Joints { .. } => Self::input(error.to_string(), ""),
            EvaluateError::Degrees(e) => Self::input(e.to_string(), ""),
            e => Self::input(
                e.to_string(),
                "Check the recording with train --check-only.",
            ),
        }
    }
}

impl From<InversionError> for Failure {
    fn from(error: InversionError) -> Self {
        match error {
            InversionError::Directory(e) => e.into(),
            InversionError::Residual(e) => e.into(),
            InversionError::Interrupted => Self::interrupted("Nothing was written."),
            e => Self::input(
                e.to_string(),
                "Give recordings of many trajectories of one length, with torque, such as the KR300 benchmark's.",
            ),
        }
    }
}

impl From<LeaderboardError> for Failure {
    fn from(error: LeaderboardError) -> Self {
        match error {
            LeaderboardError::Directory(e) => e.into(),
            LeaderboardError::Setup(e) => e.into(),
            LeaderboardError::Evaluate(e) => e.into(),
            LeaderboardError::Residual(e) => e.into(),
            LeaderboardError::Robots { .. } => Self::input(
                error.to_string(),
                "Give the models of one robot, and make a page for each robot.",
            ),
            e => Self::input(e.to_string(), ""),
        }
    }
}

impl From<PayloadError> for Failure {
    fn from(error: PayloadError) -> Self {
        match error {
            PayloadError::Evaluate(e) => e.into(),
            PayloadError::LeastSquares(_) | PayloadError::Feasibility(_) => {
                Self::other(error.to_string())
            }
            PayloadError::NoGain { .. } => Self::input(
                error.to_string(),
                "Carry a heavier body, farther from the joints, and record a longer motion of all of them.",
            ),
            PayloadError::NoTorque(_) => Self::input(
                error.to_string(),
                "Record torque or current beside the motion; a drive file names other columns.",
            ),
            PayloadError::Nothing(_) => Self::input(
                error.to_string(),
                "Record a motion of the joints that carry it: see excite.",
            ),
        }
    }
}

impl From<report::write::OutputError> for Failure {
    fn from(error: report::write::OutputError) -> Self {
        Self::input(error.to_string(), "")
    }
}

impl From<report::WriteError> for Failure {
    fn from(error: report::WriteError) -> Self {
        Self::other(error.to_string())
    }
}
