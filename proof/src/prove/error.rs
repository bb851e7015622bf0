//! What a proof cannot be run for.

/// A proof that cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum ProveError {
    /// A case cannot be made or written.
    #[error(transparent)]
    Simulate(#[from] trials::SimulateError),
    /// A case cannot be diagnosed.
    #[error("case {case}: {error}")]
    Diagnose {
        /// Its name.
        case: String,
        /// Why.
        error: Box<diagnose::DiagnoseError>,
    },
    /// No such kind of case.
    #[error("no cases are of the kind {name}; there are {kinds}")]
    Kind {
        /// Asked for.
        name: String,
        /// Those that exist.
        kinds: String,
    },
    /// A report cannot be written.
    #[error(transparent)]
    Write(#[from] report::WriteError),
    /// No cases of an earlier run.
    #[error("no cases and reports of an earlier run in {path}: {error}")]
    Kept {
        /// The folder.
        path: String,
        /// Why.
        error: std::io::Error,
    },
    /// No cases of whatever simulator.
    #[error("no cases in {path}: {error}; cases/NAME and truth/NAME.json are needed")]
    Given {
        /// The folder or file.
        path: String,
        /// Why.
        error: std::io::Error,
    },
    /// A report of an earlier run is of another draw.
    #[error(
        "{path} has case {case} of another draw, of the kind {kind} by generator {generator}; take another --out, or its --generator"
    )]
    Other {
        /// The folder.
        path: String,
        /// Name of the case.
        case: String,
        /// Its kind there.
        kind: String,
        /// Version of the generator there.
        generator: u64,
    },
    /// A file of stored answers cannot be read.
    #[error("{path}: {error}; answers as proof/tests/whole/headline.json has them are needed")]
    Stored {
        /// The file.
        path: String,
        /// Why.
        error: std::io::Error,
    },
    /// A folder cannot be made.
    #[error("cannot make {path}: {error}")]
    Folder {
        /// The folder.
        path: String,
        /// Why.
        error: std::io::Error,
    },
}

impl ProveError {
    /// Whether what was asked for, or given, is to blame.
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
