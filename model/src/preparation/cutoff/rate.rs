//! What cut-off a rate carries.

use datasets::Recording;
use datasets::prepare::PrepareOptions;

/// Highest cut-off that a rate carries, as a part of the rate.
pub const HIGHEST_PART: f64 = 0.4;

/// The options for one recording: a cut-off that its rate cannot carry becomes the highest that it can.
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
