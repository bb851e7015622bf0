//! Training job of one unit: data, settings and scaling, and the judgement whether the unit helps.

use std::sync::atomic::AtomicBool;

use feedforward::network::{Bounds, Normaliser, Unit, Weights};
use sha2::{Digest, Sha256};

use super::batches::{Item, Layout};
use super::epoch::Epoch;
use super::judge::judge_prediction;
use super::predict::predict;
use super::progress::Progress;
use super::samples::{Samples, Split};
use crate::Error;
use crate::config::UnitConfig;
#[cfg(feature = "networks")]
use crate::learning::Tensors;

/// Training job of one unit: data, split and settings.
#[derive(Debug, Clone)]
pub struct Job<'a> {
    /// Index of the joint whose residual torque is the target.
    pub joint: usize,
    /// Indices of the input columns of the unit.
    pub columns: Vec<usize>,
    /// Samples for training and validation.
    pub samples: Samples<'a>,
    /// Split into trajectories for fitting and for validation.
    pub split: Split,
    /// Settings of the unit and of its training.
    pub config: UnitConfig,
    /// Seed of the unit's first network; the others count on from it.
    pub seed: u64,
}

/// Control of a training run.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Number of threads; networks are trained independently, one per thread.
    pub threads: usize,
    /// Directory for checkpoints, one file per network, written after every epoch. Found there, they are
    /// resumed. The caller removes it once the result is safe.
    pub checkpoints: Option<&'a std::path::Path>,
    /// Flag that is raised from outside to stop between batches.
    pub cancel: Option<&'a AtomicBool>,
    /// Function that is called after every epoch of every network, from any thread.
    pub progress: Option<&'a (dyn Fn(&Progress) + Sync)>,
    /// Device of burn's tensor operations; none for the kernels. It is the only control that changes the result, by
    /// rounding.
    #[cfg(feature = "networks")]
    pub tensors: Option<&'a Tensors>,
}

impl Default for Control<'_> {
    fn default() -> Self {
        Self {
            threads: 1,
            checkpoints: None,
            cancel: None,
            progress: None,
            #[cfg(feature = "networks")]
            tensors: None,
        }
    }
}

/// Report of a unit's training.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Errors after every epoch, for each network of the unit.
    pub history: Vec<Vec<Epoch>>,
    /// Index of the epoch whose weights were kept, for each network, from 0.
    pub best_epoch: Vec<usize>,
    /// Weighted RMS error on the validation trajectories with the unit, N·m, after averaging and limits. None without
    /// such trajectories.
    pub validation_rmse: Option<f64>,
    /// Weighted RMS error on the validation trajectories without the unit, N·m. None without such trajectories.
    pub validation_rmse_off: Option<f64>,
}

/// Trained unit with the report of its training.
#[derive(Debug, Clone, PartialEq)]
pub struct Trained {
    /// Trained unit for the loop; off where it does not lower the validation error.
    pub unit: Unit,
    /// History of the training, and errors on the validation trajectories.
    pub report: Report,
}

/// Training job with the data that all its networks share.
pub(super) struct Prepared<'a, 'd> {
    /// Training job.
    pub(super) job: &'a Job<'d>,
    /// Normalisation of the inputs.
    pub(super) input: Normaliser,
    /// Normalisation of the target.
    pub(super) target: Normaliser,
    /// Range of the training inputs and largest training torque.
    pub(super) bounds: Bounds,
    /// Windows or chunks that are fitted.
    pub(super) train: Vec<Item>,
    /// Windows or chunks that decide when training stops.
    pub(super) validation: Vec<Item>,
    /// Mean of the normalised training target, at which the output starts.
    pub(super) level: f32,
    /// Digest of data and settings, for checkpoints.
    pub(super) fingerprint: String,
}

impl<'a, 'd> Prepared<'a, 'd> {
    /// Checks a job, and derives normalisation and bounds from its training samples.
    pub(super) fn new(job: &'a Job<'d>) -> Result<Self, Error> {
        let (samples, config) = (&job.samples, &job.config);
        config.check()?;
        job.split.check(samples)?;
        if job.columns.is_empty() || job.columns.iter().any(|&c| c >= samples.columns()) {
            let problem = format!("input columns {:?} of {}", job.columns, samples.columns());
            return Err(Error::Samples(problem));
        }
        let d = job.columns.len();
        let rows: Vec<usize> = job
            .split
            .train
            .iter()
            .flat_map(|&t| samples.trajectories()[t].clone())
            .filter(|&row| samples.weight(row) > 0.0)
            .collect();
        let mut table = vec![0.0; rows.len() * d];
        for (out, &row) in table.chunks_exact_mut(d).zip(&rows) {
            samples.gather(row, &job.columns, out);
        }
        let unusable = |what: &str| {
            Error::Samples(format!(
                "{what} of the training inputs overflows single precision"
            ))
        };
        let input = Normaliser::fit(config.normalisation, d, table.chunks_exact(d))
            .ok_or_else(|| unusable("the span"))?;
        let targets: Vec<f32> = rows.iter().map(|&row| samples.target(row)).collect();
        let target = Normaliser::fit(config.normalisation, 1, targets.chunks_exact(1))
            .ok_or_else(|| unusable("the target"))?;
        for row in table.chunks_exact_mut(d) {
            row.iter_mut()
                .enumerate()
                .for_each(|(j, x)| *x = input.apply(j, *x));
        }
        let limit = targets.iter().fold(0.0_f32, |m, y| m.max(y.abs()));
        let bounds = Bounds::fit(d, table.chunks_exact(d), limit, config.fade)
            .ok_or_else(|| unusable("the covariance"))?;
        let mean = targets.iter().map(|&y| f64::from(y)).sum::<f64>() / targets.len() as f64;
        let layout = Layout::new(&config.architecture, &config.training);
        let mut hash = Sha256::new();
        samples.digest(&job.columns, &mut hash);
        hash.update(format!("{:?} {:?} {:?}", config, job.split, job.columns));
        Ok(Self {
            job,
            level: target.apply(0, mean as f32),
            input,
            target,
            bounds,
            train: layout.items(samples, &job.split.train),
            validation: layout.items(samples, &job.split.validation),
            fingerprint: hash.finalize().iter().map(|b| format!("{b:02x}")).collect(),
        })
    }

    /// Unit with the given members, on.
    pub(super) fn unit(&self, members: Vec<Vec<f32>>) -> Unit {
        Unit {
            joint: self.job.joint,
            enabled: true,
            architecture: self.job.config.architecture.clone(),
            columns: self.job.columns.clone(),
            input: self.input.clone(),
            target: self.target.clone(),
            bounds: self.bounds.clone(),
            members,
            weights: Weights::default(),
        }
    }

    /// Scores the unit on the validation trajectories, and switches it off where it does not help. Returns it with the
    /// errors with and without it, N·m; none without such trajectories.
    pub(super) fn judge(&self, mut unit: Unit) -> Result<(Unit, Option<f64>, Option<f64>), Error> {
        let job = self.job;
        if job.split.validation.is_empty() {
            return Ok((unit, None, None));
        }
        let predicted = predict(&unit, &job.samples, &job.split.validation)?;
        let judged = judge_prediction(&job.samples, &job.split.validation, &job.config, &predicted);
        unit.enabled = judged.helps;
        Ok((unit, Some(judged.with), Some(judged.without)))
    }
}

/// Scores a unit on the validation trajectories of `job`, and switches it off where it does not help. The unit need not
/// have been trained by this job.
///
/// # Errors
/// As [`super::train`].
pub fn judge(job: &Job, unit: Unit) -> Result<Trained, Error> {
    let on = Unit {
        enabled: true,
        ..unit
    };
    let (unit, validation_rmse, validation_rmse_off) = Prepared::new(job)?.judge(on)?;
    Ok(Trained {
        unit,
        report: Report {
            history: Vec::new(),
            best_epoch: Vec::new(),
            validation_rmse,
            validation_rmse_off,
        },
    })
}
