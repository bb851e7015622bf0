//! Verdict of a diagnosis, from the errors that are left.

use crate::floor::SMALL;
use crate::given::Given;
use crate::schema::{Cause, UnknownJoint};
use crate::score::{Errors, figures};
use crate::tracks::Replayed;

/// Noise of each joint's positions, standard deviation in rad (m), at least that of the quantisation. It is taken from
/// third differences, in which smooth motion vanishes.
fn floors(replayed: &Replayed) -> Vec<f64> {
    (0..replayed.tracking.len())
        .map(|j| {
            let (mut sum, mut count) = (0.0, 0.0);
            for track in &replayed.whole {
                let q = track.q.column(j);
                for k in 3..q.len() {
                    sum += (q[k] - 3.0 * q[k - 1] + 3.0 * q[k - 2] - q[k - 3]).powi(2);
                    count += 1.0;
                }
            }
            // Third differences of white noise have 20 times its variance.
            let noise: f64 = (sum / f64::max(count, 1.0) / 20.0).sqrt();
            noise.max(replayed.quantum[j] / 12.0_f64.sqrt())
        })
        .collect()
}

/// Largest RMS error of a joint without a gap, as a multiple of its noise.
const AT_FLOOR: f64 = 1.5;

/// Whether each joint's error exceeds both its floor and a small part of its tracking error. The floor is the difference
/// between repeated motions, or else the noise. Where the simulator was
/// fitted to earlier recordings, errors as large as on those are small.
pub(super) fn left(errors: &Errors, heldout: &Replayed, given: &Given) -> Vec<bool> {
    let floors = heldout.repeats.clone().unwrap_or_else(|| floors(heldout));
    let figures = figures(errors, heldout);
    let usual = |j: usize| given.earlier.as_ref().and_then(|e| e.unexplained[j]);
    let joints = figures.rmse.iter().zip(&figures.unexplained).enumerate();
    joints
        .map(|(j, figures)| {
            let (Some(r), Some(u)) = figures else {
                return false;
            };
            let least = usual(j).map_or(SMALL, |usual| SMALL.max(AT_FLOOR * usual));
            *r > AT_FLOOR * floors[j] && *u > least
        })
        .collect()
}

/// Verdict in one word, from the errors on the held-out recording of the simulator as given and the corrected one.
/// Where the simulator was fitted to earlier recordings, errors as large as on those count as no gap.
pub(super) fn verdict(
    left: [&[bool]; 2],
    causes: &[Cause],
    unknown: &[UnknownJoint],
) -> &'static str {
    let [before, after] = left.map(|left| !left.contains(&true));
    match (after, causes.is_empty(), unknown.is_empty()) {
        (true, true, _) if before => "no_gap",
        (true, _, _) => "explained",
        (false, _, false) => "unknown_effect",
        (false, false, true) => "partly_explained",
        (false, true, true) => "cannot_tell",
    }
}
