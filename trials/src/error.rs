//! Errors of a simulation.

use std::path::PathBuf;

/// Reason why a simulation gave no recording.
#[derive(Debug, thiserror::Error)]
pub enum SimulateError {
    /// A simulated arm is not a possible robot.
    #[error("the simulated robot is not a possible one: {0}")]
    Robot(#[from] physics::robot::RobotError),
    /// A built-in robot is missing.
    #[error("no built-in robot `{0}`")]
    NoRobot(&'static str),
    /// The robot has elastic gears, so that the motion of its motors does not determine their torque.
    #[error(
        "the simulated robot has elastic gears: the motion of its motors does not tell their torque"
    )]
    Elastic,
    /// Random robots of which none suited the case.
    #[error("case {index} ({kind}): no random robot suits it")]
    NoCase {
        /// Name of the kind of the case.
        kind: &'static str,
        /// Index of the case in the run.
        index: u64,
    },
    /// Torques of a case do not belong together.
    #[error(transparent)]
    Shape(#[from] datasets::metrics::ShapeError),
    /// A file or folder could not be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A recording could not be written.
    #[error(transparent)]
    Recording(#[from] datasets::WriteError),
    /// An answer could not be put into JSON.
    #[error("cannot write {path} as JSON: {source}")]
    Json {
        /// Path of the answer's file.
        path: PathBuf,
        /// Error of the JSON writer.
        source: serde_json::Error,
    },
}
