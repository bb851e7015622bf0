//! Pace of the windows on recordings with another rate than the network's: windows keep their length in time.

use feedforward::clock::stride;
use std::ops::Range;

/// Step between the samples of a recording that form a window.
///
/// At a pace of two, odd and even samples are two interleaved sequences, each with the time step of the
/// training. The run-time uses one stream per phase in the same way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace(usize);

impl Pace {
    /// Pace for a recording at `rate_hz` and a network trained at `period` seconds; None where the
    /// recording is too slow for it.
    pub fn new(rate_hz: f64, period: f64) -> Option<Self> {
        stride(rate_hz * period).map(Self)
    }

    /// Rows in the order of the sequences, and the range of each sequence in that order.
    pub fn rows(self, segments: &[Range<usize>]) -> (Vec<usize>, Vec<Range<usize>>) {
        let mut rows = Vec::new();
        let mut phases = Vec::new();
        for segment in segments {
            for phase in 0..self.0.min(segment.len()) {
                let start = rows.len();
                rows.extend((segment.start + phase..segment.end).step_by(self.0));
                phases.push(start..rows.len());
            }
        }
        (rows, phases)
    }

    /// Number of sequences into which each segment is split (for segments of at least that many rows).
    pub fn phases(self) -> usize {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_and_even_samples_at_twice_the_rate() {
        let pace = Pace::new(100.0, 0.02).unwrap();
        let (rows, phases) = pace.rows(&[0..5, 5..7]);
        assert_eq!(rows, [0, 2, 4, 1, 3, 5, 6]);
        assert_eq!(phases, [0..3, 3..5, 5..6, 6..7]);
        assert_eq!(Pace::new(10.0, 0.01), None, "ten times too slow");
        assert_eq!(Pace::new(60.0, 1.0 / 60.0), Some(Pace(1)));
    }
}
