//! Residual of a model on an earlier recording, where a later one repeats its motions.
//!
//! Torque that the model lacks is the same in both, so that it cancels. The later torque is compared with the
//! earlier torque itself, and the model only bridges the small difference of the two motions.

use crate::motion::executions::Execution;
use crate::motion::frame::Frame;
use datasets::Recording;
use ndarray::{Array2, Axis};
use signal::Motion;

/// Earlier executions with the model's residual torque.
#[derive(Clone, Debug, Default)]
pub struct Replay {
    executions: Vec<(Execution, Array2<f64>)>,
    /// Part of the independent samples of the residual that the fit's parameters spent, 0 to 0.5.
    spent: f64,
}

/// Largest part of the independent samples that parameters count as spending: of more of them fewer act.
const MOST_SPENT: f64 = 0.5;

impl Replay {
    /// Adds a recording: its motion at the recorded stamps, and the residual torque there, N·m (N), shape (samples, joints).
    pub fn add(&mut self, motion: &Motion, left: &Array2<f64>) {
        let executions = motion.segments.iter().map(|rows| {
            let own = left.slice_axis(Axis(0), rows.clone().into()).to_owned();
            let execution = Execution::new(&motion.time, &motion.q, rows.clone());
            (execution, own)
        });
        self.executions.extend(executions);
    }

    /// Counts the parameters of the model's fit, whose residual holds so many independent samples.
    pub fn fitted(&mut self, parameters: usize, independent: f64) {
        self.spent = (parameters as f64 / independent.max(1.0)).min(MOST_SPENT);
    }

    /// Deviation of a single execution from the model, by joint, N·m (N): the residual without what the fit took of it.
    pub fn deviation(&self) -> Vec<f64> {
        let kept = (1.0 - self.spent).sqrt();
        self.left().into_iter().map(|left| left / kept).collect()
    }

    /// Root mean square of the residual over all earlier recordings, by joint, N·m (N).
    pub fn left(&self) -> Vec<f64> {
        let joints = self.executions.first().map_or(0, |(_, left)| left.ncols());
        let rms = |j: usize| {
            let columns = self.executions.iter().map(|(_, left)| left.column(j));
            let (sum, n) = columns.fold((0.0, 0), |(sum, n), c| (sum + c.dot(&c), n + c.len()));
            (sum / n.max(1) as f64).sqrt()
        };
        (0..joints).map(rms).collect()
    }

    /// Part of a recording's time in motions that the earlier recordings hold, and the mean number of their executions.
    pub fn known(&self, recording: &Recording) -> (f64, f64) {
        let (mut all, mut known, mut executions) = (0, 0, 0);
        for rows in recording.segments() {
            let own = Execution::new(&recording.time, &recording.q, rows.clone());
            let same = self.executions.iter();
            let same = same.filter(|(e, _)| own.shift_to(e).is_some()).count();
            all += rows.len();
            if same > 0 {
                known += rows.len();
                executions += same * rows.len();
            }
        }
        let share = known as f64 / all.max(1) as f64;
        (share, executions as f64 / known.max(1) as f64)
    }

    /// Residual at the samples of a later recording, N·m (N), shape (samples, joints): mean over all earlier
    /// executions of the motion; zero where the motion is new.
    pub fn at(&self, frame: &Frame) -> Array2<f64> {
        let motion = frame.samples();
        let mut sum = Array2::zeros(motion.q.dim());
        let mut count = vec![0; motion.len()];
        for rows in &motion.segments {
            let own = Execution::new(&motion.time, &motion.q, rows.clone());
            for (earlier, left) in &self.executions {
                let Some(shift) = own.shift_to(earlier) else {
                    continue;
                };
                let (within, values) = own.replayed(earlier, left.view(), shift);
                let at = rows.start + within.start..rows.start + within.end;
                let mut rows = sum.slice_axis_mut(Axis(0), at.clone().into());
                rows += &values;
                count[at].iter_mut().for_each(|c| *c += 1);
            }
        }
        for (mut row, &c) in sum.rows_mut().into_iter().zip(&count) {
            row /= c.max(1) as f64;
        }
        sum
    }
}
