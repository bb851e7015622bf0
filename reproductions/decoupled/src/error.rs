//! What can be wrong with a run or its identification.

use identify::least_squares::LeastSquaresError;

/// Every message says what is wrong and what to do.
#[derive(Debug, thiserror::Error)]
pub enum DecoupledError {
    /// A recording cannot be read.
    #[error(transparent)]
    Read(#[from] datasets::ReadError),
    /// A recording cannot be written.
    #[error(transparent)]
    Write(#[from] datasets::WriteError),
    /// A page or file cannot be written.
    #[error(transparent)]
    File(#[from] report::WriteError),
    /// A folder cannot be made.
    #[error("{}: cannot be made: {source}", path.display())]
    Folder {
        /// The folder.
        path: std::path::PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A recording that cannot be used.
    #[error("{source_name}: {problem}")]
    Recording {
        /// The recording.
        source_name: String,
        /// What is wrong and what to do.
        problem: String,
    },
    /// No such joint.
    #[error("there is no axis {axis}: {count} are there, counted from 1")]
    Axis {
        /// The number asked for.
        axis: usize,
        /// How many there are.
        count: usize,
    },
    /// The motion does not tell the parameters.
    #[error(
        "{estimator}: the motion does not tell the joint's parameters apart; it has to run both ways at several speeds"
    )]
    Singular {
        /// The estimator.
        estimator: &'static str,
    },
    /// Periods that cannot be averaged.
    #[error(transparent)]
    Period(#[from] datasets::periods::PeriodError),
    /// A filter that does not fit the recording's rate.
    #[error(transparent)]
    Filter(#[from] signal::sos::DesignError),
    /// Least squares.
    #[error(transparent)]
    LeastSquares(#[from] LeastSquaresError),
}

impl DecoupledError {
    /// Whether the input is at fault: exit status 2.
    pub fn is_input(&self) -> bool {
        !matches!(
            self,
            Self::Write(_) | Self::File(_) | Self::Folder { .. } | Self::LeastSquares(_)
        )
    }
}
