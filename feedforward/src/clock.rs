//! Session clock of the training recordings, and the model's memory on it.

use physics::effects::BankState;

/// Longest pause between two trajectories that memory is carried over, s.
///
/// Longer, and joints may have been moved or brakes applied meanwhile.
pub const LONGEST_PAUSE: f64 = 600.0;

/// Memory of the friction terms at the end of one training trajectory, one state per joint. A later motion on the same
/// session clock continues from it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Memory {
    /// Memory of the physical terms.
    pub physics: Vec<BankState>,
    /// Memory of the compensator's input terms; empty without one.
    pub inputs: Vec<BankState>,
}

/// Longest sampling period that a network stands, in periods of its training: its windows last that much longer then.
pub const LONGEST_PERIOD: f64 = 1.5;

/// Step between the samples of a network's window, from the samples per period of its training. None where
/// samples are too far apart for it.
pub fn stride(samples_per_period: f64) -> Option<usize> {
    let stride = samples_per_period.round().max(1.0);
    (samples_per_period * LONGEST_PERIOD >= stride).then_some(stride as usize)
}

/// The last of the spans of time (first and last stamp, s) that ended before `time`, where the pause in
/// between is short enough to carry memory over.
pub fn last_before(spans: &[[f64; 2]], time: f64) -> Option<usize> {
    spans
        .iter()
        .enumerate()
        .filter(|(_, span)| (0.0..=LONGEST_PAUSE).contains(&(time - span[1])))
        .max_by(|a, b| a.1[1].total_cmp(&b.1[1]))
        .map(|(index, _)| index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_keep_their_length_within_a_half() {
        assert_eq!(stride(1.0), Some(1));
        assert_eq!(stride(1.4), Some(1));
        assert_eq!(stride(10.2), Some(10));
        assert_eq!(stride(0.7), Some(1));
        assert_eq!(stride(0.6), None);
        assert_eq!(stride(f64::NAN), None);
    }

    #[test]
    fn the_nearest_span_within_reach() {
        let spans = [[20.0, 30.0], [0.0, 10.0]];
        assert_eq!(last_before(&spans, 31.0), Some(0));
        assert_eq!(last_before(&spans, 15.0), Some(1));
        assert_eq!(last_before(&spans, 30.0 + LONGEST_PAUSE), Some(0));
        assert_eq!(last_before(&spans, 31.0 + LONGEST_PAUSE), None);
        assert_eq!(last_before(&spans, 5.0), None);
    }
}
