//! Trial whether units help: each is trained once with folds held back.

use super::ResidualError;
use super::task::{Task, within};
use crate::physics_fit::Fit;
use crate::spread::LeftOut;
use compensator::training::{Control, Split, Trained, judge, predict, train, train_ridge};
use datasets::Recording;
use ndarray::Array2;

/// Results of the units on the folds held back; empty where there is one fold only.
#[derive(Default)]
pub(super) struct Trial {
    /// Network and ridge regression of each job on the same inputs, both trained without the folds held back.
    pub units: Vec<(Trained, Trained)>,
    /// Errors of these networks on the folds held back at their last epoch, N·m; that epoch was not chosen there.
    pub last_epoch: Vec<Option<f64>>,
    /// Errors of physics and network together where neither was fitted, by joint.
    pub left: Vec<LeftOut>,
}

impl Trial {
    /// Trains and judges the units. `apart` is the out-of-fold torque of the physics.
    pub fn run(
        task: &Task,
        fit: &Fit,
        data: &[Recording],
        apart: &[Array2<f64>],
        control: &Control,
    ) -> Result<Self, ResidualError> {
        let examples = task.examples;
        let all: Vec<usize> = (0..examples.folds.len()).collect();
        let Some(split) = hold_back(&examples.folds, &all) else {
            return Ok(Self::default());
        };
        let mut fitted = task.jobs(&examples.targets, &split)?;
        for job in &mut fitted {
            job.config.members = 1;
        }
        let networks = train(&fitted, &within(control, "validation").view(control))?;
        let judges = task.jobs(&examples.targets, &split)?;
        let places = examples.places();
        let mut found = Self::default();
        found
            .left
            .resize_with(examples.targets.len(), LeftOut::default);
        for (job, network) in judges.iter().zip(networks) {
            let epochs = network.report.history.first();
            let last = epochs.and_then(|e| e.last()?.validation_rmse);
            found.last_epoch.push(last);
            let network = judge(job, network.unit)?;
            let learned = predict(&network.unit, &job.samples, &split.validation)?;
            let physics = examples.left(data, apart, job.joint);
            let held = split.validation.iter();
            for row in held.flat_map(|&s| examples.segments[s].clone()) {
                let (part, sample) = places[row];
                let speed = fit.session.parts[part].at_samples.qd[[sample, job.joint]];
                let error = physics[row] - learned[row];
                found.left[job.joint].push(f64::from(error), speed);
            }
            found.units.push((network, train_ridge(job)?));
        }
        Ok(found)
    }
}

/// Split of the trajectories `of`. The last fold validates, and with four folds or more also the one two before
/// it: one visit to the robot alone is too little for a decision. None where they belong to one fold.
pub(super) fn hold_back(folds: &[usize], of: &[usize]) -> Option<Split> {
    let last = of.iter().map(|&i| folds[i]).max()?;
    let held = |fold: usize| fold == last || (last > 2 && fold + 2 == last);
    let (validation, train): (Vec<usize>, Vec<usize>) = of.iter().partition(|&&i| held(folds[i]));
    (!train.is_empty()).then_some(Split { train, validation })
}
