//! Trial: units of one kind, trained on folds and scored on held-out samples.

use super::data::Run;
use super::settings::{GO_ON, Settings};
use compensator::Error;
use compensator::inputs::InputSet;
use compensator::training::{Control, Fold, Job, UnitConfig, predict, train};
use feedforward::network::{Architecture, Unit};
use model::failure::Failure;
use model::residual::ResidualError;
use std::path::Path;

/// Trial: one kind of unit on some folds.
pub struct Trial<'a> {
    /// Name of the trial among the checkpoints.
    pub name: String,
    /// Run for training, and run for scoring; they differ only where samples are dealt out singly.
    pub runs: [&'a Run; 2],
    pub settings: &'a Settings,
    pub inputs: InputSet,
    pub architecture: Architecture,
    /// Index of the seed, from 0.
    pub repeat: u64,
}

/// Result of a trial on one joint.
pub struct Outcome {
    /// RMSE on the held-out trajectories of each fold, N·m.
    folds: Vec<f64>,
    /// Unit that was trained on the first fold.
    pub unit: Unit,
}

impl Outcome {
    /// Mean RMSE over folds, as the UR5 paper averages its five test sets.
    pub fn mean(&self) -> f64 {
        self.folds.iter().sum::<f64>() / self.folds.len() as f64
    }

    /// RMSE on the first fold, N·m.
    pub fn first(&self) -> f64 {
        self.folds[0]
    }
}

impl Trial<'_> {
    /// Trains every joint on every fold, all cores busy; networks that `kept` holds are not trained again.
    pub fn run(
        &self,
        joints: &[usize],
        folds: &[Fold],
        control: &Control,
        kept: &Path,
    ) -> Result<Vec<Outcome>, Failure> {
        let [moves, scored] = self.runs;
        let kept = kept.join(&self.name);
        let control = &Control {
            checkpoints: Some(&kept),
            ..*control
        };
        let mut jobs = Vec::new();
        for &joint in joints {
            let samples = moves.samples(joint)?;
            for fold in folds {
                jobs.push(Job {
                    joint,
                    columns: self.inputs.columns(joint, moves.tau.ncols()),
                    samples,
                    split: fold.split.clone(),
                    config: UnitConfig {
                        architecture: self.architecture.clone(),
                        training: self.settings.training.clone(),
                        ..UnitConfig::ucm()
                    },
                    seed: self.seed(joint),
                });
            }
        }
        let mut trained = train(&jobs, control)
            .map_err(|error| match error {
                Error::Interrupted => Failure::interrupted(GO_ON),
                other => ResidualError::from(other).into(),
            })?
            .into_iter();
        let mut outcomes = Vec::new();
        for (&joint, jobs) in joints.iter().zip(jobs.chunks(folds.len())) {
            let (mut errors, mut first) = (Vec::new(), None);
            for ((fold, job), trained) in folds.iter().zip(jobs).zip(trained.by_ref()) {
                let learned = predict(&trained.unit, &job.samples, &fold.test)
                    .map_err(ResidualError::from)?;
                errors.push(scored.rmse(joint, &fold.test, |row| f64::from(learned[row])));
                first.get_or_insert(trained.unit);
            }
            if let Some(unit) = first {
                outcomes.push(Outcome {
                    folds: errors,
                    unit,
                });
            }
        }
        Ok(outcomes)
    }

    /// Seed of a network. The study's own seeds and those of its repeats never meet.
    fn seed(&self, joint: usize) -> u64 {
        let own = self.settings.seed.wrapping_add(joint as u64);
        own.wrapping_add(self.repeat << 32)
    }
}
