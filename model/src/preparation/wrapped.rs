//! Angles that were wrapped to one turn before they were stored.

use datasets::Recording;
use ndarray::ArrayViewMut1;
use physics::robot::Robot;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Largest step over a seam, relative to the longest other step of the joint.
const LIKE_OTHERS: f64 = 2.0;

/// Unwraps angles of rotating joints that jump by a turn; a note names the joints.
///
/// A jump counts where, minus a whole number of turns, it is a step like the joint's others. Any other jump is
/// damage and is kept.
pub fn unwrap(robot: &Robot, recording: &mut Recording) {
    let segments = recording.segments();
    let mut seams = Vec::new();
    for (j, joint) in robot.joints().iter().enumerate().take(recording.dof()) {
        if !joint.kind.is_rotation() {
            continue;
        }
        let count = whole(recording.q.column_mut(j), &segments);
        let tables = [&mut recording.ql, &mut recording.q_ref];
        for table in tables.into_iter().flatten() {
            whole(table.column_mut(j), &segments);
        }
        if count > 0 {
            let times = if count == 1 { "once" } else { "times" };
            let count = if count == 1 {
                String::new()
            } else {
                format!("{count} ")
            };
            seams.push(format!("{} {count}{times}", joint.name));
        }
    }
    if !seams.is_empty() {
        recording.notes.push(format!(
            "angles were wrapped to one turn and are put together again: {}",
            seams.join(", ")
        ));
    }
}

/// Unwraps one column; returns the number of seams.
fn whole(mut angle: ArrayViewMut1<'_, f64>, segments: &[Range<usize>]) -> usize {
    let rows = || segments.iter().flat_map(|s| s.start + 1..s.end);
    let steps = |angle: &ArrayViewMut1<'_, f64>| -> Vec<f64> {
        rows().map(|r| angle[r] - angle[r - 1]).collect()
    };
    let usual = steps(&angle)
        .into_iter()
        .map(f64::abs)
        .filter(|s| *s <= PI)
        .fold(0.0, f64::max);
    let mut seams = 0;
    for segment in segments {
        let (mut turns, mut last) = (0.0, angle[segment.start]);
        for row in segment.start + 1..segment.end {
            let step = angle[row] - last;
            last = angle[row];
            let folded = step - TAU * (step / TAU).round();
            if step.abs() > PI && folded.abs() <= LIKE_OTHERS * usual {
                turns -= (step / TAU).round();
                seams += 1;
            }
            angle[row] += TAU * turns;
        }
    }
    seams
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    fn recording(angle: impl Fn(f64) -> f64) -> Recording {
        let time: Vec<f64> = (0..400).map(|i| f64::from(i) * 0.01).collect();
        let q = Array2::from_shape_fn((400, 6), |(i, j)| if j == 0 { angle(time[i]) } else { 0.1 });
        Recording::new("made", time, q, None)
    }

    #[test]
    fn seams_of_both_directions_and_ranges_are_closed() {
        let robot = Robot::builtin("ur5").unwrap();
        let swing = |t: f64| 4.5 * (1.7 * t).sin();
        let wrapped: [&dyn Fn(f64) -> f64; 3] = [
            &|t| (swing(t) + PI).rem_euclid(TAU) - PI,
            &|t| swing(t).rem_euclid(TAU),
            &|t| (9.0 * t).rem_euclid(TAU),
        ];
        for fold in wrapped {
            let mut found = recording(fold);
            unwrap(&robot, &mut found);
            let steps = found.q.column(0).to_vec();
            assert!(steps.windows(2).all(|w| (w[1] - w[0]).abs() < 0.1));
            assert_eq!(found.notes.len(), 1, "{:?}", found.notes);
        }
    }

    #[test]
    fn a_motion_that_goes_on_and_damage_stay_as_they_are() {
        let robot = Robot::builtin("ur5").unwrap();
        let smooth = recording(|t| 5.0 * (1.1 * t).sin());
        // Far from a whole turn.
        let damaged = recording(|t| {
            if (t - 2.0).abs() < 0.005 {
                4.0
            } else {
                0.3 * t.sin()
            }
        });
        for before in [smooth, damaged] {
            let mut after = before.clone();
            unwrap(&robot, &mut after);
            assert_eq!(after, before);
        }
    }
}
