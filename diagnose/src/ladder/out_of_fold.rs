//! Residuals out of fold on the fitted recording, and the gain of a change of the fit there.

use crate::algebra::fit::{Fit, Variable};
use crate::input::frames::Frames;
use crate::motion::frame::Frame;
use crate::motion::scene::Scene;
use crate::search::find::{Columns, Findings};
use ndarray::Array2;
use std::ops::Range;

/// The fitted recording with every sample predicted by the fit that left its fold out.
pub struct OutOfFold<'a> {
    frame: &'a Frame,
    gap: &'a Array2<f64>,
    columns: Columns,
    /// Ranges of the recorded samples of each fold.
    folds: Vec<Vec<Range<usize>>>,
    weight: &'a Array2<f64>,
    /// Blocks of rows that the bootstrap draws.
    blocks: Vec<Range<usize>>,
}

impl<'a> OutOfFold<'a> {
    /// Predictions for all variables that any fit of `found` may have. `gap` is at the recorded samples, shape
    /// (samples, joints); `weight` is of the fitted rows, shape (rows, joints).
    pub fn new(
        found: &Findings,
        frames: &'a Frames,
        gap: &'a Array2<f64>,
        weight: &'a Array2<f64>,
    ) -> Self {
        let frame = &frames.data;
        let scene = Scene::new(&found.session.present, frames.passage(), &frames.scale);
        let samples = |rows: &Range<usize>| frame.samples_of(rows.clone());
        let folds = frame
            .folds()
            .iter()
            .map(|f| f.scored.iter().map(samples).collect())
            .collect();
        let settings = &found.settings.ladder;
        let length = ((settings.stretch * frame.row_rate()) as usize).max(1);
        let blocks = if frame.rows.len() >= settings.trajectories {
            frame.rows.clone()
        } else {
            let stretches = frame.rows.iter().flat_map(|t| {
                let n = (t.len() / length).max(1);
                let (start, rows) = (t.start, t.len());
                (0..n).map(move |k| start + k * rows / n..start + (k + 1) * rows / n)
            });
            stretches.collect()
        };
        Self {
            frame,
            gap,
            columns: Columns::new(&found.dictionary, &scene, frame, &found.tight.0),
            folds,
            weight,
            blocks,
        }
    }

    /// Torque of the fit's variables that `keep` selects, shape (samples, joints).
    pub fn torque(&self, fit: &Fit, keep: impl Fn(usize) -> bool) -> Array2<f64> {
        let kept = |v: &[Variable]| -> Vec<usize> { (0..v.len()).filter(|i| keep(*i)).collect() };
        let kept = kept(&fit.variables);
        let variables: Vec<Variable> = kept.iter().map(|&i| fit.variables[i]).collect();
        let mut out = Array2::zeros(self.gap.dim());
        for (fold, beta) in self.folds.iter().zip(fit.betas()) {
            let beta = kept.iter().map(|&i| beta[i]).collect();
            for rows in fold {
                self.columns.add(&mut out, rows.clone(), &variables, &beta);
            }
        }
        out
    }

    /// Residual of a fit out of fold, shape (samples, joints).
    pub fn residual(&self, fit: &Fit) -> Array2<f64> {
        self.gap - &self.torque(fit, |_| true)
    }

    /// Weighted squared error on the fitted rows, by block and joint, (N·m)².
    pub fn losses(&self, residual: &Array2<f64>) -> Vec<Vec<f64>> {
        let rows = self.frame.table_thin(residual);
        let of = |block: &Range<usize>, j: usize| -> f64 {
            block
                .clone()
                .map(|i| self.weight[[i, j]] * rows[[i, j]] * rows[[i, j]])
                .sum()
        };
        let joints = residual.ncols();
        let each = |b: &Range<usize>| (0..joints).map(|j| of(b, j)).collect();
        self.blocks.iter().map(each).collect()
    }
}

/// Part of the joints' squared error that a change removes, and its 90 % interval by bootstrap over blocks,
/// before and after paired.
pub fn gain(before: &[Vec<f64>], after: &[Vec<f64>], joints: &[usize]) -> (f64, [f64; 2]) {
    let sum = |b: &[f64]| joints.iter().map(|&j| b[j]).sum::<f64>();
    let pairs: Vec<(f64, f64)> = before
        .iter()
        .zip(after)
        .map(|(b, a)| (sum(b) - sum(a), sum(b)))
        .collect();
    signal::bootstrap::ratio(&pairs)
}
