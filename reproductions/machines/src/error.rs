//! What can be wrong with a machine, its recording or its identification.

use std::path::PathBuf;

/// Every message says what is wrong and what to do.
#[derive(Debug, thiserror::Error)]
pub enum MachineError {
    /// A file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Neither a built-in machine nor a file.
    #[error("no built-in machine and no file is called {name:?}; the built-in ones are {builtins}")]
    Unknown {
        /// Name asked for.
        name: String,
        /// Names that exist.
        builtins: String,
    },
    /// A description that cannot be used.
    #[error("machine {name:?}: {reason}")]
    Description {
        /// Name of the machine, or of its file.
        name: String,
        /// What is wrong and what to do.
        reason: String,
    },
    /// A robot or drive file.
    #[error(transparent)]
    Robot(#[from] physics::robot::RobotError),
    /// A recording.
    #[error(transparent)]
    Recording(#[from] datasets::ReadError),
    /// A recording cannot be prepared.
    #[error("{0}")]
    Prepare(#[from] datasets::prepare::PrepareError),
    /// Positions that the machine cannot take.
    #[error(
        "{source_name}, row {row}: the arms cannot meet at the positions {positions:?} rad; check joint zeros, directions \
         and the geometry of the description"
    )]
    OutOfReach {
        /// The recording.
        source_name: String,
        /// Row, from 1.
        row: usize,
        /// Positions of the axes.
        positions: Vec<f64>,
    },
    /// No torque in the recording.
    #[error("{0}: has no torque; only prediction does without")]
    NoTorque(String),
    /// A filter that does not fit.
    #[error("the filter's cut-off of {cutoff_hz} Hz {problem}")]
    Filter {
        /// Cut-off asked for.
        cutoff_hz: f64,
        /// What is wrong with it and what to do.
        problem: String,
    },
    /// Thresholds that do not fit the machine.
    #[error("{what}: {found} values for {axes} axes; give one for each, none negative")]
    Thresholds {
        /// Which.
        what: &'static str,
        /// Values given.
        found: usize,
        /// Axes of the machine.
        axes: usize,
    },
    /// Too few samples in motion.
    #[error("axis {axis}: {reason}")]
    TooFewSamples {
        /// Name of the axis.
        axis: String,
        /// What is missing and what to do.
        reason: String,
    },
    /// The equations cannot be solved.
    #[error(transparent)]
    LeastSquares(#[from] identify::least_squares::LeastSquaresError),
    /// A stored model cannot be used.
    #[error("{}: {reason}", path.display())]
    Store {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] report::WriteError),
    /// A recording cannot be written.
    #[error(transparent)]
    WriteRecording(#[from] datasets::WriteError),
    /// A folder cannot be made.
    #[error("{}: cannot be made: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

impl MachineError {
    /// Whether the input is at fault: exit status 2.
    pub fn is_input(&self) -> bool {
        !matches!(
            self,
            Self::Write(_) | Self::WriteRecording(_) | Self::Folder { .. }
        )
    }
}
