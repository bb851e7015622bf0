//! Linear baselines of the KR300 benchmark paper (J. Weigand, J. Götz, J. Ulmen, M. Ruskowski,
//! "Dataset and Baseline for an Industrial Robot Identification Benchmark", version 2.0, 2022), and
//! what has been published on it.

pub mod forward;
pub mod inverse;
mod normal;
pub mod published;

pub use forward::{FORWARD, ForwardBaseline, ForwardSettings, LinearForward};
pub use inverse::LinearInverse;
pub use normal::Normalisation;

use ::identify::least_squares::LeastSquaresError;

/// Reason why a baseline could not be fitted or applied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BaselineError {
    /// Table of the wrong shape.
    #[error("{what} has the shape {found:?} (samples, joints), needed is {needed:?}")]
    Shape {
        /// Name of the table that has the wrong shape.
        what: &'static str,
        /// Shape of the table as found (samples, joints).
        found: (usize, usize),
        /// Shape that is needed (samples, joints).
        needed: (usize, usize),
    },
    /// NaN or infinite values in the named table.
    #[error("{0} holds NaN or infinite values")]
    NotFinite(&'static str),
    /// Too few samples for the fit.
    #[error("{found} samples in unbroken stretches are too few: at least {needed} are needed")]
    TooShort {
        /// Number of usable samples.
        found: usize,
        /// Number of samples needed.
        needed: usize,
    },
    /// Trajectories that reach beyond the tables, by index.
    #[error("trajectory {0} reaches beyond the last sample")]
    Trajectory(usize),
    /// Settings that describe no model.
    #[error("a state-space model needs at least one state and a horizon of two samples")]
    Settings,
    /// Matrix decomposition that did not converge.
    #[error("a matrix decomposition did not converge")]
    Decomposition,
    /// Least-squares problem that cannot be solved.
    #[error(transparent)]
    LeastSquares(#[from] LeastSquaresError),
}

/// Refuses a table of another shape than needed or with values that are not finite.
fn check(
    what: &'static str,
    table: ndarray::ArrayView2<f64>,
    needed: (usize, usize),
) -> Result<(), BaselineError> {
    if table.dim() != needed {
        let found = table.dim();
        return Err(BaselineError::Shape {
            what,
            found,
            needed,
        });
    }
    if table.iter().any(|v| !v.is_finite()) {
        return Err(BaselineError::NotFinite(what));
    }
    Ok(())
}
