//! Linear least squares on tall systems A x ≈ b that never have to be in memory at once.
//!
//! Rows are folded block by block into the triangular factor of [A b] ([`Accumulator`]); every question
//! about the fit (parameters, covariance, residual of any parameter vector or any subset of columns,
//! condition numbers) is then answered from that small [`Triangle`]. Triangles of groups of rows
//! stack exactly into the triangle of all of them, which is what leave-one-group-out needs.
//! [`Gram`] is the faster, less accurate view of the same data for searches over subsets of columns.

mod condition;
mod gram;
mod jackknife;
mod solve;
mod triangle;

#[cfg(test)]
mod tests;

pub use condition::{SubRegressors, condition_number};
pub use gram::{Gram, GramFit};
pub use jackknife::{block_covariance, refitted_deviations};
pub use solve::{Estimate, Prior, SolveOptions, solve};
pub use triangle::{Accumulator, Triangle};

/// Reason why a least-squares problem could not be set up or solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LeastSquaresError {
    /// A row, a vector or another triangle has the wrong number of columns.
    #[error("{what} has {found} entries where the problem has {expected}")]
    Size {
        /// Name of the quantity with the wrong size.
        what: &'static str,
        /// Size of the quantity as found.
        found: usize,
        /// The size that the problem asks for.
        expected: usize,
    },
    /// NaN or infinite values among the rows that were accumulated.
    #[error("the system holds NaN or infinite values")]
    NotFinite,
    /// Triangle without rows, or with rows of zero weight alone.
    #[error("the system has no rows")]
    NoRows,
    /// A column index beyond the last column.
    #[error("column {column} does not exist: the problem has {columns} columns")]
    NoSuchColumn {
        /// Index of the missing column.
        column: usize,
        /// Number of columns of the problem.
        columns: usize,
    },
    /// A prior with a standard deviation that is not positive.
    #[error("the prior standard deviation of column {column} is not positive")]
    BadPrior {
        /// Index of the column with that deviation.
        column: usize,
    },
    /// A noise whose standard deviation is not positive.
    #[error("the noise of column {column} has no positive standard deviation")]
    BadNoise {
        /// The column, among the noisy ones.
        column: usize,
    },
    /// A known column that nothing ties to the noisy ones, so that their scale is open.
    #[error("the known column says nothing of the scale of the noisy ones")]
    NoScale,
    /// The iteration of a decomposition did not converge.
    #[error("the singular value decomposition did not converge")]
    Decomposition,
}

/// Refuses a vector of the wrong length.
pub(crate) fn check_size(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), LeastSquaresError> {
    if found == expected {
        Ok(())
    } else {
        Err(LeastSquaresError::Size {
            what,
            found,
            expected,
        })
    }
}
