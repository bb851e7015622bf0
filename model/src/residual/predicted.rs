//! Residual torque of a recording by any learner trained on its inputs.

use super::error::ResidualError;
use super::pace::Pace;
use compensator::training::{Samples, predict};
use feedforward::network::Unit;
use ndarray::{Array1, Array2, Axis};
use std::ops::Range;

/// Learner of one joint's residual torque.
pub(super) trait Learner {
    /// Index of the joint whose residual torque is learned.
    fn joint(&self) -> usize;
    /// Residual torque of every row of `sequences`, N·m.
    fn residual(
        &self,
        samples: &Samples,
        sequences: &[usize],
    ) -> Result<Vec<f32>, compensator::Error>;
}

impl Learner for Unit {
    fn joint(&self) -> usize {
        self.joint
    }

    fn residual(
        &self,
        samples: &Samples,
        sequences: &[usize],
    ) -> Result<Vec<f32>, compensator::Error> {
        predict(self, samples, sequences)
    }
}

/// Sum of the learners' torques from a table of inputs, shape (samples, joints); each segment starts from a reset.
pub(super) fn summed<L: Learner>(
    learners: &[L],
    joints: usize,
    table: &Array2<f32>,
    segments: &[Range<usize>],
    pace: Pace,
) -> Result<Array2<f64>, ResidualError> {
    let (rows, phases) = pace.rows(segments);
    let paced = table.select(Axis(0), &rows);
    let mut torque = Array2::zeros((table.nrows(), joints));
    let nothing = Array1::<f32>::zeros(rows.len());
    let samples = Samples::new(paced.view(), nothing.view(), None, &phases)?;
    let all: Vec<usize> = (0..phases.len()).collect();
    for learner in learners {
        let residual = learner.residual(&samples, &all)?;
        for (&row, value) in rows.iter().zip(residual) {
            torque[[row, learner.joint()]] += f64::from(value);
        }
    }
    Ok(torque)
}
