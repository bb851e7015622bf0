//! Training of the units on what the physics leaves.

use super::inputs::{Preset, input_table, inputs, remember};
use super::{Pace, ResidualError, predict_from};
use crate::directory::sha256;
use crate::physics_fit::Fit;
use compensator::training::{
    Control, Job, Loss, Samples, Schedule, Split, Trained, Training, UnitConfig, train, train_ridge,
};
use datasets::Recording;
use datasets::metrics::MOVING;
use feedforward::clock::Memory;
use feedforward::inputs::{CompensatorRecord, UnitValidation};
use feedforward::network::Compensator;
use ndarray::{Array1, Array2, Axis};
use physics::robot::Builtin;
use std::ops::Range;

/// Settings of [`train_residual`].
#[derive(Clone, Debug)]
pub struct ResidualOptions {
    /// Which compensator.
    pub preset: Preset,
    /// Seed of the networks.
    pub seed: u64,
    /// Networks averaged per unit; None: the preset's number.
    pub members: Option<usize>,
    /// Passes over the data; None: the preset's number.
    pub epochs: Option<usize>,
    /// Train on moving samples alone.
    pub moving_only: bool,
}

impl ResidualOptions {
    /// Networks that a training of `joints` units goes through, the trial included.
    pub fn networks(&self, joints: usize) -> usize {
        joints * (1 + config(self, 1).members)
    }
}

/// A trained compensator with what `model.json` says of it.
pub struct Learned {
    /// The units.
    pub compensator: Compensator,
    /// Its file.
    pub bytes: Vec<u8>,
    /// Its record.
    pub record: CompensatorRecord,
    /// The model's memory with that of the units' inputs.
    pub memory: Vec<Memory>,
    /// Residual torque of every recording of the session, shape (samples, joints).
    pub torque: Vec<Array2<f64>>,
}

/// Settings of a unit for `samples` training samples.
///
/// The default's rates and widths were chosen on KR300 training groups alone; an epoch visits part of
/// the samples so that long recordings do not take longer than they teach.
fn config(options: &ResidualOptions, samples: usize) -> UnitConfig {
    let mut config = match options.preset {
        Preset::Ucm => {
            let ucm = UnitConfig::ucm();
            let training = Training {
                share: (30_000.0 / samples as f32).min(1.0),
                ..ucm.training.clone()
            };
            UnitConfig { training, ..ucm }
        }
        Preset::Default => {
            let (learning_rate, epochs) = if options.moving_only {
                (5e-3, 16)
            } else {
                (1e-2, 24)
            };
            UnitConfig {
                members: 3,
                training: Training {
                    epochs,
                    batch: 128,
                    share: (20_000.0 / samples as f32).min(0.5),
                    learning_rate,
                    schedule: Schedule::OneCycle {
                        warm_up: 0.15,
                        start: 0.1,
                        end: 1e-3,
                    },
                    dropout: 0.0,
                    loss: Loss::Mse,
                    patience: epochs,
                    ..Training::default()
                },
                ..UnitConfig::default()
            }
        }
    };
    if let Some(members) = options.members {
        config.members = members;
    }
    if let Some(epochs) = options.epochs {
        config.training.epochs = epochs;
    }
    config
}

/// Trains one unit per joint on the residual of the first `data.len()` recordings of the session.
///
/// Whether a unit helps is judged by a first, shorter training that holds one fold back: where it does
/// not lower the error there, it is switched off. The units that stay on are then trained on everything,
/// for a fixed number of epochs.
///
/// # Errors
/// Too little data, values that are not finite, an interruption (checkpoints stay).
pub fn train_residual(
    fit: &Fit,
    data: &[Recording],
    options: &ResidualOptions,
    control: &Control,
) -> Result<Learned, ResidualError> {
    let joints = fit.file.joints.len();
    let model = fit.file.physics.model()?;
    let (list, seen) = inputs(
        options.preset,
        joints,
        options.moving_only,
        fit.file.physics.builtin.and_then(Builtin::nested_gears),
    );
    let load = fit.session.load(model.load_robot());
    let tables = input_table(&fit.session, &list, &load, &[]);
    // Windows keep their length in time: faster recordings are taken apart into several sequences.
    let period = 1.0 / fit.file.preprocessing.rate_hz;
    let paces: Vec<(usize, Pace)> = (0..data.len())
        .filter_map(|i| Some((i, Pace::new(fit.session.parts[i].report.rate_hz, period)?)))
        .collect();
    let mut rows = Vec::new();
    let mut segments: Vec<Range<usize>> = Vec::new();
    let mut folds = Vec::new();
    let mut blocks = Vec::new();
    let mut start = 0;
    for &(i, pace) in &paces {
        let (order, phases) = pace.rows(&fit.session.parts[i].at_samples.segments);
        let lengths = fit.session.parts[i]
            .at_samples
            .segments
            .iter()
            .map(ExactSizeIterator::len);
        for (fold, length) in fit.fold[i].iter().zip(lengths) {
            folds.extend(std::iter::repeat_n(*fold, pace.phases().min(length)));
        }
        segments.extend(phases.iter().map(|s| start + s.start..start + s.end));
        blocks.push(tables[i].select(Axis(0), &order));
        start += order.len();
        rows.push((i, order));
    }
    let stacked = stack(&blocks);
    let targets: Vec<Array1<f32>> = (0..joints).map(|j| residual(fit, data, &rows, j)).collect();
    let weights: Vec<Array1<f32>> = (0..joints)
        .map(|j| weight(fit, &rows, j, options.moving_only))
        .collect();
    let jobs = |split: &Split| -> Result<Vec<Job<'_>>, ResidualError> {
        let mut jobs = Vec::new();
        for joint in 0..joints {
            if !weights[joint].iter().any(|w| *w > 0.0) {
                continue;
            }
            jobs.push(Job {
                joint,
                columns: seen[joint].clone(),
                samples: Samples::new(
                    stacked.view(),
                    targets[joint].view(),
                    Some(weights[joint].view()),
                    &segments,
                )?,
                split: split.clone(),
                config: config(options, start),
                seed: options.seed.wrapping_add(joint as u64),
            });
        }
        Ok(jobs)
    };
    let everything = Split {
        train: (0..segments.len()).collect(),
        validation: Vec::new(),
    };
    let held = hold_back(&folds);
    let trial = match &held {
        Some(split) => {
            let mut jobs = jobs(split)?;
            for job in &mut jobs {
                job.config.members = 1;
            }
            let networks = train(&jobs, &within(control, "validation").view(control))?;
            let ridges: Vec<Trained> = jobs.iter().map(train_ridge).collect::<Result<_, _>>()?;
            networks.into_iter().zip(ridges).collect()
        }
        None => Vec::new(),
    };
    let finals = jobs(&everything)?;
    let mut units = Vec::new();
    let trained = train(&finals, &within(control, "final").view(control))?;
    let mut validation = Vec::new();
    for (k, mut trained) in trained.into_iter().enumerate() {
        let trial = trial.get(k);
        if let Some((network, _)) = trial {
            trained.unit.enabled = network.unit.enabled;
        }
        validation.push(UnitValidation {
            joint: fit.file.joints[trained.unit.joint].clone(),
            enabled: trained.unit.enabled,
            physics: trial.and_then(|(n, _)| n.report.validation_rmse_off),
            with_unit: trial.and_then(|(n, _)| n.report.validation_rmse),
            with_ridge: trial.and_then(|(_, r)| r.report.validation_rmse),
        });
        units.push(trained.unit);
    }
    let compensator = Compensator {
        joints: fit.file.joints.clone(),
        inputs: list.iter().map(|i| i.name()).collect(),
        units,
    };
    let bytes = compensator.to_bytes()?;
    let torque = tables
        .iter()
        .zip(&fit.session.parts)
        .map(
            |(table, part)| match Pace::new(part.report.rate_hz, period) {
                Some(pace) => predict_from(&compensator, table, &part.at_samples.segments, pace),
                None => Ok(Array2::zeros(part.at_samples.q.dim())),
            },
        )
        .collect::<Result<_, _>>()?;
    let record = CompensatorRecord {
        inputs: list,
        period,
        sha256: sha256(&bytes),
        validation,
    };
    let mut memory = fit.file.memory.clone();
    remember(&mut memory, &fit.session, &record.inputs, &load, data.len());
    Ok(Learned {
        memory,
        compensator,
        bytes,
        record,
        torque,
    })
}

/// Checkpoints of one phase of the training.
struct Phase {
    directory: Option<std::path::PathBuf>,
}

fn within(control: &Control, phase: &str) -> Phase {
    Phase {
        directory: control.checkpoints.map(|c| c.join(phase)),
    }
}

impl Phase {
    fn view<'a>(&'a self, control: &Control<'a>) -> Control<'a> {
        Control {
            checkpoints: self.directory.as_deref(),
            ..*control
        }
    }
}

/// The last fold validates, and where there are four or more the one two before it: one visit to the
/// robot alone decides too little. None where there is one fold only.
fn hold_back(folds: &[usize]) -> Option<Split> {
    let last = folds.iter().copied().max().filter(|&last| last > 0)?;
    let held = |fold: usize| fold == last || (last > 2 && fold + 2 == last);
    let (validation, train) = (0..folds.len()).partition(|&i| held(folds[i]));
    Some(Split { train, validation })
}

fn stack(tables: &[Array2<f32>]) -> Array2<f32> {
    let views: Vec<_> = tables.iter().map(|t| t.view()).collect();
    ndarray::concatenate(Axis(0), &views).unwrap_or_default()
}

/// Measured torque minus physics in the order of the sequences.
fn residual(
    fit: &Fit,
    data: &[Recording],
    rows: &[(usize, Vec<usize>)],
    joint: usize,
) -> Array1<f32> {
    let mut target = Vec::new();
    for (i, order) in rows {
        let Some(tau) = &data[*i].tau else { continue };
        let physics = &fit.physics[*i];
        target.extend(
            order
                .iter()
                .map(|&r| (tau[[r, joint]] - physics[[r, joint]]) as f32),
        );
    }
    target.into()
}

fn weight(fit: &Fit, rows: &[(usize, Vec<usize>)], joint: usize, moving_only: bool) -> Array1<f32> {
    let mut weights = Vec::new();
    for (i, order) in rows {
        let qd = &fit.session.parts[*i].at_samples.qd;
        let moves = |r: usize| qd[[r, joint]].abs() > MOVING;
        weights.extend(
            order
                .iter()
                .map(|&r| if !moving_only || moves(r) { 1.0 } else { 0.0 }),
        );
    }
    weights.into()
}
