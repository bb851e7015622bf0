//! A robot's earlier recordings as the model that a later gap is measured from: no simulator is asked.
//!
//! The model is identified from the earlier recordings alone; the description gives lengths, axes and a prior of the masses. Where the
//! later recording repeats a motion, its torque is compared with the earlier torque itself.

use crate::error::DiagnoseError;
use crate::simulator::{NominalModel, Replay};
use datasets::Recording;
use model::physics_fit::{FitOptions, fit_physics};
use ndarray::Array2;
use physics::robot::Robot;

/// The model of a robot from its earlier recordings.
///
/// # Errors
/// Recordings without torque, or from which nothing can be identified.
pub fn model(
    robot: &Robot,
    before: &[Recording],
    cutoff_hz: Option<f64>,
) -> Result<NominalModel, DiagnoseError> {
    let mut options = FitOptions::default();
    options.prepare.cutoff_hz = cutoff_hz;
    let fit = fit_physics(robot, before, None, &options)?;
    let mut replay = Replay::default();
    for ((recording, part), physics) in before.iter().zip(&fit.session.parts).zip(&fit.physics) {
        let tau = recording
            .tau
            .as_ref()
            .ok_or_else(|| DiagnoseError::NoTorque(recording.source.clone()))?;
        let left: Array2<f64> = tau - physics;
        replay.add(&part.at_samples, &left);
    }
    let tests = fit.file.diagnostics.iter().flat_map(|d| &d.residual_tests);
    let independent = tests.flatten().map(|t| t.serial.effective_samples).sum();
    replay.fitted(fit.identified.estimate.rank, independent);
    Ok(NominalModel::identified(&fit.file)?.with_replay(replay))
}

/// Indices of a later recording's trajectories that are scored, where no other file is: every third, of two the last.
fn scored(trajectories: usize) -> Vec<usize> {
    match trajectories {
        2 => vec![1],
        n => (0..n).filter(|i| i % 3 == 2).collect(),
    }
}

/// Part of a single trajectory that is fitted, and the gap between it and the scored part, s.
const FITTED: f64 = 0.7;
const GAP: f64 = 1.0;

/// Fitted and scored part of the later recording, where no separate file is scored.
pub fn split(after: &Recording) -> (Recording, Recording) {
    if after.trajectories.len() > 1 {
        return after.split(&scored(after.trajectories.len()));
    }
    let rows = after.trajectories[0].range.clone();
    let fitted = rows.start + (FITTED * rows.len() as f64) as usize;
    let from = after.time[fitted.min(rows.end - 1)] + GAP;
    let scored = after.time.partition_point(|t| *t < from).min(rows.end - 1);
    (
        after.stretches(&[(0, rows.start..fitted)]),
        after.stretches(&[(0, scored..rows.end)]),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(lengths: &[usize]) -> Recording {
        let n = lengths.iter().sum();
        let time = (0..n).map(|k| 0.01 * k as f64).collect();
        let mut made = Recording::new("made", time, Array2::zeros((n, 1)), None);
        made.trajectories.clear();
        let mut start = 0;
        for (i, length) in lengths.iter().enumerate() {
            made.trajectories.push(datasets::Trajectory {
                label: i.to_string(),
                range: start..start + length,
            });
            start += length;
        }
        made
    }

    #[test]
    fn what_is_scored_is_not_fitted() {
        let labels = |r: &Recording| -> Vec<String> {
            r.trajectories.iter().map(|t| t.label.clone()).collect()
        };
        let (fitted, held) = split(&recording(&[300; 7]));
        assert_eq!(
            (labels(&fitted).len(), labels(&held)),
            (5, vec!["2".into(), "5".into()])
        );
        let (fitted, held) = split(&recording(&[300, 300]));
        assert_eq!(
            (labels(&fitted), labels(&held)),
            (vec!["0".into()], vec!["1".into()])
        );
        let (fitted, held) = split(&recording(&[1000]));
        assert_eq!(fitted.len(), 700);
        assert!(held.time[0] - fitted.time[699] >= GAP);
        assert_eq!(held.len(), 200);
    }
}
