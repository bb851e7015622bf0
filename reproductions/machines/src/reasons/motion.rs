//! Too slow, too short, too small a region.

use super::{Kind, Reason};
use crate::identification::Identified;
use datasets::Recording;
use signal::quantile::quantile;

/// Part of an axis's speed limit that its motion should reach ("close to the maximum velocity" in the manual).
const FAST: f64 = 0.3;
/// Part of the samples that should be in motion.
const MOVING: f64 = 0.5;
/// Cycles that each axis should make (manual).
const CYCLES: f64 = 3.0;
/// Part of the range between its limits that an axis should cover ("close to its full position range" in the manual).
const REGION: f64 = 0.6;

/// What is wrong with the motion of one axis. A semi-static model is to move slowly and needs no cycles.
pub(super) fn of_axis(identified: &Identified, recording: &Recording, axis: usize) -> Vec<Reason> {
    let (machine, result) = (&identified.machine, &identified.axes[axis]);
    let described = &machine.axes()[axis];
    let (name, unit) = (&described.name, described.speed_unit());
    let semi_static = machine.model().is_semi_static();
    let reason = |kind, value, message| Reason {
        kind,
        axis: Some(axis),
        value,
        message,
    };
    let mut found = Vec::new();
    let kept = identified.samples[1];
    let share = result.samples as f64 / kept.max(1) as f64;
    let velocity = identified.signals.motion.qd.column(axis);
    let speeds: Vec<f64> = velocity.iter().map(|v| v.abs()).collect();
    let top = quantile(speeds, 0.99).unwrap_or(0.0);
    if !semi_static && top < FAST * described.speed {
        let message = format!(
            "{name} moves at {top:.3} {unit} at most, its limit is {:.3}: inertia hardly shows beside friction and gravity, \
             and fast motion will be predicted poorly; move it faster",
            described.speed
        );
        found.push(reason(Kind::TooSlow, top, message));
    } else if share < MOVING {
        let message = format!(
            "{name} is within its speed band in {:.0} % of the samples; move it {}",
            100.0 * share,
            if semi_static {
                "steadily and slowly"
            } else {
                "faster"
            }
        );
        found.push(reason(Kind::TooSlow, share, message));
    }
    // Every stroke ends in a reversal but the last of a trajectory.
    let strokes = reversals(identified, recording, axis) + recording.trajectories.len();
    let cycles = 0.5 * strokes as f64;
    if !semi_static && cycles < CYCLES {
        let message = format!("{name} makes {cycles:.1} cycles; record at least three");
        found.push(reason(Kind::TooShort, cycles, message));
    }
    let q = recording.q.column(axis);
    let (low, high) = q
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| {
            (a.min(*v), b.max(*v))
        });
    let part = (high - low) / (described.upper - described.lower);
    if part < REGION {
        let message = format!(
            "{name} covers {:.0} % of the range between its limits; the model may hold there alone; let it move further",
            100.0 * part
        );
        found.push(reason(Kind::RegionTooSmall, part, message));
    }
    found
}

/// Changes of direction between speeds above the axis's threshold, within trajectories.
fn reversals(identified: &Identified, recording: &Recording, axis: usize) -> usize {
    let lower = identified.axes[axis].band.lower;
    let velocity = identified.signals.motion.qd.column(axis);
    let mut count = 0;
    for range in recording.segments() {
        let mut direction = 0.0;
        for v in range.map(|row| velocity[row]).filter(|v| v.abs() >= lower) {
            if direction * v < 0.0 {
                count += 1;
            }
            direction = v.signum();
        }
    }
    count
}
