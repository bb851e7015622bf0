//! Units of one kind, trained on folds and scored on what they never saw.

use super::data::Data;
use super::settings::Settings;
use compensator::inputs::InputSet;
use compensator::training::{Control, Fold, Job, UnitConfig, predict, train};
use feedforward::network::{Architecture, Unit};
use model::failure::Failure;
use model::residual::ResidualError;

/// One kind of unit.
pub struct Trial<'a> {
    pub data: &'a Data,
    pub settings: &'a Settings,
    pub inputs: InputSet,
    pub architecture: Architecture,
}

/// One joint's result.
pub struct Outcome {
    /// RMSE on the held-out trajectories of each fold, N·m.
    folds: Vec<f64>,
    /// Unit of the first fold.
    pub unit: Unit,
}

impl Outcome {
    /// Mean over folds, as the paper averages its five test sets.
    pub fn mean(&self) -> f64 {
        self.folds.iter().sum::<f64>() / self.folds.len() as f64
    }

    /// The first fold's.
    pub fn first(&self) -> f64 {
        self.folds[0]
    }
}

impl Trial<'_> {
    /// Trains every joint on every fold, all cores busy.
    pub fn run(
        &self,
        joints: &[usize],
        folds: &[Fold],
        control: &Control,
    ) -> Result<Vec<Outcome>, Failure> {
        let moves = &self.data.moves;
        let mut jobs = Vec::new();
        for &joint in joints {
            let samples = moves.samples(joint)?;
            for fold in folds {
                jobs.push(Job {
                    joint,
                    columns: self.inputs.columns(joint, self.data.joints.len()),
                    samples,
                    split: fold.split.clone(),
                    config: UnitConfig {
                        architecture: self.architecture.clone(),
                        training: self.settings.training.clone(),
                        ..UnitConfig::ucm()
                    },
                    seed: self.settings.seed.wrapping_add(joint as u64),
                });
            }
        }
        let mut trained = train(&jobs, control)
            .map_err(ResidualError::from)?
            .into_iter();
        let mut outcomes = Vec::new();
        for (&joint, jobs) in joints.iter().zip(jobs.chunks(folds.len())) {
            let (mut errors, mut first) = (Vec::new(), None);
            for ((fold, job), trained) in folds.iter().zip(jobs).zip(trained.by_ref()) {
                let learned = predict(&trained.unit, &job.samples, &fold.test)
                    .map_err(ResidualError::from)?;
                errors.push(moves.rmse(joint, &fold.test, |row| f64::from(learned[row])));
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
}
