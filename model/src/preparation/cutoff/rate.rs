//! Highest cut-off for a sampling rate.

use datasets::Recording;
use datasets::prepare::PrepareOptions;

/// Highest cut-off relative to the sampling rate.
pub const HIGHEST_PART: f64 = 0.4;

/// Options for one recording: a cut-off above the highest for its rate is replaced by that.
pub fn for_recording(options: &PrepareOptions, recording: &Recording) -> PrepareOptions {
    let highest = HIGHEST_PART / recording.median_step();
    PrepareOptions {
        // What is no number stays none, and is refused.
        cutoff_hz: options
            .cutoff_hz
            .map(|hz| if hz > highest { highest } else { hz }),
        ..*options
    }
}
