//! Consecutive trajectories of a recording, on which columns are evaluated together. All but friction's memory stays within a
//! trajectory, so that the memory of a search does not grow with the recording.

use ndarray::{Array2, Axis};
use signal::Motion;
use std::ops::Range;

/// Least number of fine samples of a part, as far as there are any: their columns stay in the cache.
const LEAST: usize = 4096;

/// Motion of some trajectories of a recording.
pub struct Part {
    /// Their samples in the recording's motion.
    pub(super) samples: Range<usize>,
    pub(super) motion: Motion,
    pub(super) wide: Option<Motion>,
}

impl Part {
    /// Trajectories of each part of a motion.
    pub fn all(motion: &Motion) -> Vec<Range<usize>> {
        let mut out: Vec<Range<usize>> = Vec::new();
        let mut length = LEAST;
        for (k, segment) in motion.segments.iter().enumerate() {
            match out.last_mut() {
                Some(last) if length < LEAST => last.end = k + 1,
                _ => {
                    out.push(k..k + 1);
                    length = 0;
                }
            }
            length += segment.len();
        }
        out
    }

    /// Samples of some trajectories of a motion, at least one.
    pub fn samples(motion: &Motion, trajectories: &Range<usize>) -> Range<usize> {
        let segments = &motion.segments;
        segments[trajectories.start].start..segments[trajectories.end - 1].end
    }

    /// Part of a motion with these trajectories, at least one. `wide` is the motion in the whole band of the rows.
    pub fn new(motion: &Motion, wide: Option<&Motion>, trajectories: &Range<usize>) -> Self {
        let segments = &motion.segments[trajectories.clone()];
        Self {
            samples: Self::samples(motion, trajectories),
            motion: cut(motion, segments),
            wide: wide.map(|wide| cut(wide, segments)),
        }
    }
}

/// Motion in some consecutive segments.
fn cut(motion: &Motion, segments: &[Range<usize>]) -> Motion {
    let start = segments[0].start;
    let rows = start..segments[segments.len() - 1].end;
    let own = |t: &Array2<f64>| t.slice_axis(Axis(0), rows.clone().into()).to_owned();
    Motion {
        time: motion.time[rows.clone()].to_vec(),
        segments: segments
            .iter()
            .map(|s| s.start - start..s.end - start)
            .collect(),
        q: own(&motion.q),
        qd: own(&motion.qd),
        qdd: own(&motion.qdd),
    }
}
