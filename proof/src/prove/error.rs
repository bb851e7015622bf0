//! Errors of a proof.

/// A proof that cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum ProveError {
    /// The observer of what can be known has no answer to a case.
    #[error("case {case}: the observer has no answer: {reason}")]
    Observer {
        /// Name of the case.
        case: String,
        /// Reason.
        reason: String,
    },
    /// A case cannot be made or written.
    #[error(transparent)]
    Simulate(#[from] trials::SimulateError),
    /// A case cannot be diagnosed.
    #[error("case {case}: {error}")]
    Diagnose {
        /// Name of the case that cannot be diagnosed.
        case: String,
        /// Error of the diagnosis.
        error: Box<diagnose::DiagnoseError>,
    },
    /// Kind of case that does not exist.
    #[error("no cases are of the kind {name}; there are {kinds}")]
    Kind {
        /// Name of the kind that was asked for.
        name: String,
        /// Names of the kinds that exist.
        kinds: String,
    },
    /// A report cannot be written.
    #[error(transparent)]
    Write(#[from] report::WriteError),
    /// A folder without cases of an earlier run.
    #[error("no cases and reports of an earlier run in {path}: {error}")]
    Kept {
        /// Path of the folder without cases.
        path: String,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// A folder without cases of any simulator.
    #[error("no cases in {path}: {error}; cases/NAME and truth/NAME.json are needed")]
    Given {
        /// Path of the folder or file.
        path: String,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// A report of an earlier run is of another draw.
    #[error(
        "{path} has case {case} of another draw, of the kind {kind} by generator {generator}; take another --out, or its --generator"
    )]
    Other {
        /// Path of the folder with other cases.
        path: String,
        /// Name of the case that is stored there.
        case: String,
        /// Kind of the case that is stored there.
        kind: String,
        /// Version of the generator of the case that is stored there.
        generator: u64,
    },
    /// A file of stored answers cannot be read.
    #[error("{path}: {error}; answers as proof/tests/whole/headline.json has them are needed")]
    Stored {
        /// Path of the file of stored answers.
        path: String,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// Folder that cannot be made.
    #[error("cannot make {path}: {error}")]
    Folder {
        /// Path of the folder to be made.
        path: String,
        /// Error of the operating system.
        error: std::io::Error,
    },
}

impl ProveError {
    /// Whether the request or the input is at fault.
    pub fn is_input(&self) -> bool {
        match self {
            Self::Kind { .. }
            | Self::Kept { .. }
            | Self::Stored { .. }
            | Self::Given { .. }
            | Self::Other { .. } => true,
            Self::Diagnose { error, .. } => error.is_input(),
            _ => false,
        }
    }
}
