//! Errors of the design of motions.

use crate::least_squares::LeastSquaresError;

/// Reason why no exciting trajectory could be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExcitationError {
    /// Limits that leave no motion, or are not finite.
    #[error(
        "joint {} has no room to move: range, velocity, acceleration and jerk limits must be positive, and all but jerk finite",
        joint + 1
    )]
    NoRoom {
        /// Index of the joint without room, from 0.
        joint: usize,
    },
    /// A limit under which a joint cannot get anywhere in the time it has.
    #[error(
        "joint {}: under a {limit} limit of {value:.4} it moves by {stroke:.4} at most in {period} s, less than {needed:.4}, \
         a twentieth of its range; that takes {enough:.2} s",
        joint + 1
    )]
    TooSlow {
        /// Index of the joint that is too slow, from 0.
        joint: usize,
        /// Name of the limit: `velocity`, `acceleration` or `jerk`.
        limit: &'static str,
        /// Value of the limit, rad or m per sⁿ.
        value: f64,
        /// Period of the motion, there and back, s.
        period: f64,
        /// Largest range of a periodic motion of that period, rad or m.
        stroke: f64,
        /// Least stroke that is needed, rad or m.
        needed: f64,
        /// Period from which the joint reaches that stroke, s.
        enough: f64,
    },
    /// A sine over a joint's range that its limits stretch too far for the time given.
    #[error(
        "joint {}: within its limits a sine over its range takes {cycle:.2} s, so {cycles} periods and the ramps take {needed:.1} s; \
         {duration} s are too short",
        joint + 1
    )]
    FewCycles {
        /// Index of the joint with too few periods, from 0.
        joint: usize,
        /// Duration of one period, s.
        cycle: f64,
        /// Number of periods that are wanted.
        cycles: f64,
        /// Duration of all wanted periods, s.
        needed: f64,
        /// Duration of the motion as given, s.
        duration: f64,
    },
    /// Joint for which every set of frequencies has whole ratios.
    #[error("joint {}: no frequency within its limits is far enough from whole multiples of the others'", joint + 1)]
    Commensurate {
        /// Index of the joint, from 0.
        joint: usize,
    },
    /// A home pose outside the joint's limits.
    #[error("joint {}: home is {home}, outside the range from {lower:.4} to {upper:.4} that the motion may use", joint + 1)]
    HomeOutside {
        /// Index of the joint, from 0.
        joint: usize,
        /// Position of the joint at home, rad or m.
        home: f64,
        /// Lowest position of the joint, rad or m.
        lower: f64,
        /// Highest position of the joint, rad or m.
        upper: f64,
    },
    /// The tool is outside its region at home.
    #[error("the tool is {outside:.3} m outside its region at home")]
    ToolOutsideAtHome {
        /// Distance of the tool from its region, m.
        outside: f64,
    },
    /// Joint limits within which no pose has the tool in its region.
    #[error("no pose within the joints' limits was found that has the tool in its region")]
    ToolNowhere,
    /// Search without a motion that stays within the tool's region.
    #[error("no motion was found that keeps the tool in its region and tells every parameter")]
    NothingFound,
    /// Fewer harmonics than rest at the ends takes.
    #[error("{harmonics} harmonics cannot start and end at rest; at least {needed} are needed")]
    FewHarmonics {
        /// Number of harmonics given.
        harmonics: usize,
        /// Least number of harmonics.
        needed: usize,
    },
    /// Motion of no joints, harmonics, time or samples, by that name.
    #[error("nothing to optimise: {0} must be positive")]
    Empty(&'static str),
    /// The regressor could not be judged.
    #[error(transparent)]
    LeastSquares(#[from] LeastSquaresError),
}
