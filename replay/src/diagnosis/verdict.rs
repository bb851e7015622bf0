//! What is left of the gap.

use crate::schema::{Cause, UnknownJoint};
use crate::score::{Errors, figures};
use crate::tracks::Replayed;

/// Noise of each joint's positions: by third differences, in which smooth motion vanishes, and no less than the quantum's.
pub(super) fn floors(replayed: &Replayed) -> Vec<f64> {
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
            // Of white noise third differences have 20 times the variance.
            let noise: f64 = (sum / f64::max(count, 1.0) / 20.0).sqrt();
            noise.max(replayed.quantum[j] / 12.0_f64.sqrt())
        })
        .collect()
}

/// Largest multiple of the floor, and largest unexplained part, at which a joint has no gap.
pub(super) const AT_FLOOR: f64 = 1.5;

pub(super) const SMALL: f64 = 0.05;

pub(super) fn verdict(
    after: &Errors,
    heldout: &Replayed,
    floors: &[f64],
    causes: &[Cause],
    unknown: &[UnknownJoint],
) -> &'static str {
    let figures = figures(after, heldout);
    let joints = figures.rmse.iter().zip(&figures.unexplained).zip(floors);
    let done = joints.filter_map(|((r, u), floor)| Some(((*r)?, (*u)?, floor)));
    let small = done
        .into_iter()
        .all(|(r, u, floor)| r <= AT_FLOOR * floor || u <= SMALL);
    match (small, causes.is_empty(), unknown.is_empty()) {
        (true, true, _) => "no_gap",
        (true, false, _) => "explained",
        (false, _, false) => "unknown_effect",
        (false, false, true) => "partly_explained",
        (false, true, true) => "cannot_tell",
    }
}
