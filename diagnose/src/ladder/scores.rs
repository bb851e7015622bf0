//! Scores of residuals by the metric of `eval`.

use crate::motion::frame::Frame;
use crate::schema::Step;
use datasets::metrics::{Scope, Scores, deviations};
use datasets::{Recording, repeats};
use ndarray::Array2;

/// Joints and samples of a recording that are scored.
#[derive(Clone, Debug)]
pub struct Scored {
    dead: Vec<bool>,
    kept: Vec<bool>,
}

impl Scored {
    /// Scores all joints but the dead ones, at the samples `kept`.
    pub fn new(dead: &[bool], kept: Vec<bool>) -> Self {
        Self {
            dead: dead.to_vec(),
            kept,
        }
    }

    /// The table, shape (samples, joints), with zeros for dead joints.
    pub fn judged(&self, mut table: Array2<f64>) -> Array2<f64> {
        let columns = table.columns_mut().into_iter().zip(&self.dead);
        for (mut column, _) in columns.filter(|c| *c.1) {
            column.fill(0.0);
        }
        table
    }

    /// Whether a sample is scored.
    pub fn keeps(&self, sample: usize) -> bool {
        self.kept[sample]
    }

    /// Number of samples that are scored.
    pub fn samples(&self) -> usize {
        self.kept.iter().filter(|k| **k).count()
    }

    /// A step of the ladder: scores of a residual at the recorded samples of a frame, shape (samples, joints).
    pub fn step(&self, name: &str, residual: &Array2<f64>, frame: &Frame) -> Step {
        Step {
            step: name.to_owned(),
            samples: self.samples(),
            all: self.figures(residual, frame, Scope::All),
            moving: self.figures(residual, frame, Scope::Moving),
        }
    }

    /// RMSE and NRMSE of a residual by joint in one scope.
    pub fn figures(&self, residual: &Array2<f64>, frame: &Frame, scope: Scope) -> Scores {
        let qd = frame.samples().qd.view();
        let deviations = deviations(frame.tau.view(), qd);
        let all = Scores::of_errors(residual.view(), &deviations, qd, scope, |i| self.kept[i])
            .expect("a residual has the shape of its recording");
        let judged = all.rmse.iter().zip(&self.dead);
        let rmse = judged.map(|(r, dead)| r.filter(|_| !dead)).collect();
        Scores::relative(rmse, &deviations)
    }
}

/// Step `repeatability`, the noise floor: spread of the torque over executions of one motion. None where no motion is repeated.
pub fn repeatability(recording: &Recording, frame: &Frame) -> Option<Step> {
    let qd = &frame.samples().qd;
    let floor = repeats::repeatability(recording, qd, frame.repeats())?;
    let deviations = deviations(frame.tau.view(), qd.view());
    let all = floor.all.into_iter().map(Some).collect();
    Some(Step {
        step: "repeatability".to_owned(),
        samples: frame.tau.nrows(),
        all: Scores::relative(all, &deviations),
        moving: Scores::relative(floor.moving, &deviations),
    })
}

/// Sum over joints of squared NRMSE.
pub fn total(figures: &Scores) -> f64 {
    figures.nrmse.iter().flatten().map(|v| v * v).sum()
}
