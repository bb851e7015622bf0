//! Units of positions that a recording itself shows.

use datasets::Recording;
use physics::robot::Robot;
use std::f64::consts::{PI, TAU};

/// Line of a drive file that declares degrees.
const LINE: &str = "units.angle = \"deg\"";

/// Positions of rotating joints that can only be degrees, or percentages of a range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "{file}: q{} runs over {span:.0} ({turns:.1} turns, were it rad), where {joint} has {room:.1} rad, and so do \
     {alike} of {moving} moving joints: {}",
    .index + 1, means(*.percent)
)]
pub struct Degrees {
    /// Name of the recording whose positions are degrees.
    pub file: String,
    /// Index of the joint with the longest motion.
    pub index: usize,
    /// Name of the joint with the longest motion.
    pub joint: String,
    /// Range of the joint's positions, in the recorded unit.
    pub span: f64,
    /// Range of the joint's positions in turns, if the numbers were rad.
    pub turns: f64,
    /// Range between the joint's limits, rad.
    pub room: f64,
    /// Number of joints that exceed their range.
    pub alike: usize,
    /// Number of joints that move.
    pub moving: usize,
    /// Whether the positions end at ±100: percent of each motor's range, as LeRobot stores it.
    pub percent: bool,
}

/// Explanation of the positions' unit, with what to do about it.
fn means(percent: bool) -> String {
    if percent {
        "the numbers end at ±100, so they are per cent of each motor's range, which no description turns into angles; record in degrees (in \
         LeRobot: use_degrees=true of robot and teleoperator), or give scale and zero of each joint by converting the table"
            .to_owned()
    } else {
        format!(
            "the positions are in degrees; declare it by the line `{LINE}` in a drive file (--drive FILE.toml)"
        )
    }
}

/// Range assumed for a joint without limits, rad, since it may turn on and on.
const UNLIMITED: f64 = 4.0 * TAU;
/// Factor on a joint's range from which its motion exceeds it.
const BEYOND: f64 = 1.5;
/// Range of motion below which a joint is not judged, in degrees.
const SMALL: f64 = 1.0;

/// Refuses recorded positions that are provably degrees. At least half of the moving joints exceed the robot's
/// range, wherever their zeros are, and no joint does when the numbers are read as degrees. A motion of few degrees
/// proves nothing.
///
/// # Errors
/// The proof.
pub fn refuse_degrees(robot: &Robot, recording: &Recording) -> Result<(), Degrees> {
    let spans: Vec<(usize, f64, f64)> = robot
        .joints()
        .iter()
        .enumerate()
        .take(recording.dof())
        .filter(|(_, joint)| joint.kind.is_rotation())
        .map(|(j, joint)| {
            let (low, high) = recording
                .q
                .column(j)
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &q| {
                    (low.min(q), high.max(q))
                });
            let room = joint.limits.upper - joint.limits.lower;
            // Limits of zero width are a placeholder, those of many turns say nothing.
            let room = if room > 0.1 {
                room.min(UNLIMITED)
            } else {
                UNLIMITED
            };
            (j, high - low, room)
        })
        .filter(|(_, span, _)| *span > SMALL)
        .collect();
    let alike = spans
        .iter()
        .filter(|(_, span, room)| *span > BEYOND * room)
        .count();
    let fit = spans
        .iter()
        .all(|(_, span, room)| span * PI / 180.0 <= BEYOND * room);
    let longest = spans.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    match longest {
        Some(&(index, span, room)) if fit && 2 * alike >= spans.len().max(2) => Err(Degrees {
            file: recording.source.clone(),
            index,
            joint: robot.joints()[index].name.clone(),
            span,
            turns: span / TAU,
            room,
            alike,
            moving: spans.len(),
            percent: is_percent(recording),
        }),
        _ => Ok(()),
    }
}

/// Warning for positions that were declared as degrees and look like percent of a range; none otherwise.
pub fn looks_like_percent(recording: &Recording) -> Option<String> {
    let mut declared = recording.clone();
    declared.q.mapv_inplace(f64::to_degrees);
    is_percent(&declared).then(|| {
        "read as degrees the positions end at ±100 exactly: if they are per cent of each motor's range (LeRobot's default), record in degrees \
         (use_degrees=true)"
            .to_owned()
    })
}

/// Whether no position is beyond ±100, and at least two joints (or the only one) come within 1 of it on a side.
/// A motion in degrees has no reason to end there.
fn is_percent(recording: &Recording) -> bool {
    let largest = |j: usize| {
        recording
            .q
            .column(j)
            .iter()
            .fold(0.0_f64, |m, q| m.max(q.abs()))
    };
    let ends = (0..recording.dof()).filter(|&j| (99.0..=100.0).contains(&largest(j)));
    (0..recording.dof()).all(|j| largest(j) <= 100.0) && ends.count() >= recording.dof().min(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    fn recording(reach: [f64; 6]) -> Recording {
        let time: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.01).collect();
        let q = Array2::from_shape_fn((200, 6), |(i, j)| {
            reach[j] * (0.03 * i as f64 + j as f64).sin()
        });
        Recording::new("made.csv", time, q, None)
    }

    #[test]
    fn degrees_are_proven_by_the_way_that_joints_go() {
        let robot = Robot::builtin("ur5").unwrap();
        let error =
            refuse_degrees(&robot, &recording([60.0, 40.0, 50.0, 30.0, 20.0, 0.1])).unwrap_err();
        assert_eq!((error.moving, error.index), (5, 0));
        assert!(error.to_string().contains("in degrees"), "{error}");
        let drive = physics::robot::drive::Drive::from_toml(LINE, &robot).unwrap();
        assert!((drive.position_conversion(&robot)[0].scale - PI / 180.0).abs() < 1e-15);
    }

    #[test]
    fn radians_never_are() {
        let robot = Robot::builtin("ur5").unwrap();
        for reach in [
            [1.5; 6],
            // A last joint that turns on and on.
            [1.5, 1.0, 1.0, 1.0, 1.0, 40.0],
            // So small a motion may be either.
            [3.0, 2.0, 4.0, 2.0, 1.0, 3.0],
            [0.0; 6],
        ] {
            assert_eq!(
                refuse_degrees(&robot, &recording(reach)),
                Ok(()),
                "{reach:?}"
            );
        }
    }
}
