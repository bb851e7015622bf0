//! Joint motion on a common clock, cut into trajectories.

use ndarray::Array2;
use std::ops::Range;

/// Motion of all joints of one robot, sampled row by row.
///
/// Every table has shape (samples, joints). Units are rad, rad/s, rad/s² for revolute joints and
/// m, m/s, m/s² for prismatic ones. Nothing is filtered, differentiated or windowed across the
/// border of two segments; states with memory (friction, warm-up) do run on over it, in order of
/// `time`.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Time stamps in s, one per sample; increasing within a segment.
    pub time: Vec<f64>,
    /// Row ranges of the trajectories, in order, without gaps: they cover `0..time.len()`.
    pub segments: Vec<Range<usize>>,
    /// Joint positions, rad (m), shape (samples, joints).
    pub q: Array2<f64>,
    /// Joint velocities, rad/s (m/s), shape (samples, joints).
    pub qd: Array2<f64>,
    /// Joint accelerations, rad/s² (m/s²), shape (samples, joints).
    pub qdd: Array2<f64>,
}

impl Motion {
    /// Number of samples of the motion.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether the motion has no sample.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Number of joints of the motion.
    pub fn dof(&self) -> usize {
        self.q.ncols()
    }
}
