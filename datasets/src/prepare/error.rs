//! Reasons why a recording cannot be prepared.

use signal::sos;
use signal::spline::SplineError;

/// A recording that cannot be prepared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PrepareError {
    /// The cut-off does not fit the rate.
    #[error("{0}")]
    Cutoff(#[from] sos::DesignError),
    /// The low-pass that the recorded torque has passed does not fit the rate.
    #[error("torque_filter of the drive file: {0}")]
    TorqueFilter(sos::DesignError),
    /// Stamps that no recording of as many samples has: another unit than s, or a clock that was set meanwhile.
    #[error(
        "trajectory `{label}`: {samples} samples over {span:.6} s, most of them {step:.6} s apart, the largest gap {gap:.6} s before row {row} of \
         the recording"
    )]
    Clock {
        /// Label of the trajectory with the gap in time.
        label: String,
        /// Number of samples of the trajectory.
        samples: usize,
        /// Time from the first to the last stamp, s.
        span: f64,
        /// Median step of the recording, s.
        step: f64,
        /// Largest step of the trajectory, s.
        gap: f64,
        /// Number of the row after the largest step, from 1.
        row: usize,
    },
    /// A spline that cannot be put through a trajectory.
    #[error("trajectory `{label}`: {source}")]
    Spline {
        /// Label of the trajectory that the spline fails on.
        label: String,
        /// Reason of the failure.
        source: SplineError,
    },
    /// The fine rate is not a positive number.
    #[error("fine rate {0} Hz is not positive")]
    FineRate(f64),
}

impl PrepareError {
    /// Remedy for the problem, as a sentence.
    pub fn advice(&self) -> &'static str {
        match self {
            Self::Cutoff(_) => "Give another --cutoff-hz.",
            Self::TorqueFilter(_) => {
                "Give the low-pass that the recorded torque has passed (torque_filter of the drive file)."
            }
            Self::Clock { .. } => {
                "Give the unit of time (units.time of the drive file), or cut the recording there."
            }
            Self::Spline { .. } => "Give a recording with longer trajectories.",
            Self::FineRate(_) => "",
        }
    }
}
