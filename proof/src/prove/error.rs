//! Errors of a proof.

/// A proof that cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum ProveError {
    /// A case cannot be made or written.
    #[error(transparent)]
    Simulate(#[from] trials::SimulateError),
    /// A case cannot be diagnosed.
    #[error("case {case}: {error}")]
    Diagnose {
        /// Name of the case.
        case: String,
        /// Cause.
        error: Box<diagnose::DiagnoseError>,
    },
    /// An unknown kind of case.
    #[error("no cases are of the kind {name}; there are {kinds}")]
    Kind {
        /// The name asked for.
        name: String,
        /// Names that exist.
        kinds: String,
    },
    /// A report cannot be written.
    #[error(transparent)]
    Write(#[from] report::WriteError),
    /// A folder without cases of an earlier run.
    #[error("no cases and reports of an earlier run in {path}: {error}")]
    Kept {
        /// Path of the folder.
        path: String,
        /// Cause.
        error: std::io::Error,
    },
    /// A folder without cases of any simulator.
    #[error("no cases in {path}: {error}; cases/NAME and truth/NAME.json are needed")]
    Given {
        /// The folder or file.
        path: String,
        /// Cause.
        error: std::io::Error,
    },
    /// A report of an earlier run is of another draw.
    #[error(
        "{path} has case {case} of another draw, of the kind {kind} by generator {generator}; take another --out, or its --generator"
    )]
    Other {
        /// Path of the folder.
        path: String,
        /// Name of the case.
        case: String,
        /// Kind of the case there.
        kind: String,
        /// Version of the generator there.
        generator: u64,
    },
    /// A file of stored answers cannot be read.
    #[error("{path}: {error}; answers as proof/tests/whole/headline.json has them are needed")]
    Stored {
        /// Path of the file.
        path: String,
        /// Cause.
        error: std::io::Error,
    },
    /// A folder cannot be made.
    #[error("cannot make {path}: {error}")]
    Folder {
        /// Path of the folder.
        path: String,
        /// Cause.
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
