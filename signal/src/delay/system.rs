//! Data, range and result of the search for a delay.

use statrs::distribution::{ContinuousCDF, StudentsT};
use std::ops::Range;

/// Columns and target on uniform grids, segment by segment.
#[derive(Clone, Debug, Default)]
pub struct System {
    /// Columns, each over all rows.
    pub columns: Vec<Vec<f64>>,
    /// Target of the fit over all rows.
    pub target: Vec<f64>,
    /// Ranges of rows that follow each other.
    pub segments: Vec<Range<usize>>,
    /// Time between the rows of each segment, s.
    pub steps: Vec<f64>,
}

/// Range and resolution of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Smallest and largest delay, s. A minimum at either end is not taken as the delay.
    pub range: [f64; 2],
    /// Distance of the delays tried before the best is refined, s.
    pub spacing: f64,
    /// Shortest block of the jackknife, s.
    pub block: f64,
}

impl Search {
    /// The delays tried before the best is refined, ends included.
    pub(super) fn tries(&self) -> impl Iterator<Item = f64> + use<> {
        let [low, high] = self.range;
        let count = ((high - low) / self.spacing).ceil().max(1.0) as usize;
        (0..=count).map(move |k| low + k as f64 * (high - low) / count as f64)
    }
}

impl Default for Search {
    fn default() -> Self {
        Self {
            range: [-0.06, 0.2],
            spacing: 0.01,
            block: 1.0,
        }
    }
}

/// A delay with everything needed to judge it.
#[derive(Clone, Debug, PartialEq)]
pub struct Delay {
    /// Delay of the target after the columns, s.
    pub delay: f64,
    /// Standard deviation of the delay, s.
    pub std: f64,
    /// Number of blocks behind `std`.
    pub blocks: usize,
    /// Coefficients of the columns at the delay.
    pub coefficients: Vec<f64>,
}

impl Delay {
    /// Interval of 95 %: Student's quantile of the number of blocks.
    pub fn interval(&self) -> [f64; 2] {
        let half = student_975(self.blocks.saturating_sub(1)) * self.std;
        [self.delay - half, self.delay + half]
    }
}

/// The value that Student's t with `dof` degrees of freedom exceeds with a chance of 2.5 %; infinite without any.
pub fn student_975(dof: usize) -> f64 {
    student(0.025, dof)
}

/// One-sided quantile of Student's t that is exceeded with probability `chance`.
pub fn student(chance: f64, dof: usize) -> f64 {
    StudentsT::new(0.0, 1.0, dof as f64).map_or(f64::INFINITY, |t| t.inverse_cdf(1.0 - chance))
}
