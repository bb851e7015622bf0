//! The loop that trains one network from one seed.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use feedforward::network::Architecture;
use pulp::Arch;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::adam::Adam;
use super::batches::{Gatherer, Item};
use super::config::{Schedule, Training};
use super::state::{Epoch, Position, State};
use crate::Error;
use crate::engine::{Dropout, Network};

/// One network under training.
#[derive(Debug)]
pub(super) struct Trainer<'a, 'd> {
    gather: &'a Gatherer<'a, 'd>,
    architecture: &'a Architecture,
    settings: &'a Training,
    seed: u64,
    train: &'a [Item],
    validation: &'a [Item],
    network: Network<f32>,
    arch: Arch,
    pub(super) state: State,
    gradient: Vec<f32>,
    dropout: Dropout<f32>,
    outputs: Vec<f32>,
    slopes: Vec<f32>,
}

/// Independent generator for each purpose and moment.
fn generator(seed: u64, purpose: u8, epoch: usize, batch: usize) -> ChaCha8Rng {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(&(epoch as u64).to_le_bytes());
    key[16..24].copy_from_slice(&(batch as u64).to_le_bytes());
    key[24] = purpose;
    ChaCha8Rng::from_seed(key)
}

/// Uniform in ±1/√(inputs of a unit); LSTM forget biases start at 1 so that gradients reach back, and the
/// output starts at `level`.
fn initial(
    architecture: &Architecture,
    inputs: usize,
    level: f32,
    rng: &mut ChaCha8Rng,
) -> Vec<f32> {
    let mut parameters = Vec::new();
    let tensors = architecture.tensors(inputs).unwrap_or_default();
    let last = tensors.len().saturating_sub(1);
    for (i, t) in tensors.iter().enumerate() {
        let lstm = t.name.starts_with("encoder") || t.name.starts_with("reencoder");
        let fan = if lstm {
            t.shape[1] / 4
        } else {
            t.shape[0].max(if t.name == "attention.score" {
                t.shape[1]
            } else {
                1
            })
        };
        let bound = 1.0 / (fan as f32).sqrt();
        let bias = t.name.ends_with("bias");
        parameters.extend((0..t.range.len()).map(|k| match () {
            () if i == last => level,
            () if bias && lstm && k / fan == 1 => 1.0,
            () if bias => 0.0,
            () => rng.random_range(-bound..bound),
        }));
    }
    parameters
}

impl<'a, 'd> Trainer<'a, 'd> {
    /// A fresh network whose output starts at `level` (normalised), or one resumed from `state`.
    pub(super) fn new(
        gather: &'a Gatherer<'a, 'd>,
        (architecture, settings): (&'a Architecture, &'a Training),
        (train, validation): (&'a [Item], &'a [Item]),
        seed: u64,
        level: f32,
        state: Option<State>,
    ) -> Result<Self, Error> {
        let inputs = gather.columns.len();
        let too_large = || Error::Config {
            setting: "architecture",
            problem: "a width is zero or absurdly large".into(),
        };
        let network = Network::new(architecture, inputs).ok_or_else(too_large)?;
        let state = state.unwrap_or_else(|| {
            let parameters = initial(architecture, inputs, level, &mut generator(seed, 0, 0, 0));
            State {
                adam: Adam::new(parameters.len()),
                best: parameters.clone(),
                parameters,
                progress: Position {
                    batch: 0,
                    loss: 0.0,
                    weight: 0.0,
                    history: Vec::new(),
                    best_epoch: 0,
                    stale: 0,
                    plateau: 0,
                    rate: 1.0,
                    finished: false,
                },
            }
        });
        Ok(Self {
            gather,
            architecture,
            settings,
            seed,
            train,
            validation,
            network,
            arch: Arch::new(),
            gradient: vec![0.0; state.parameters.len()],
            state,
            dropout: Dropout::default(),
            outputs: Vec::new(),
            slopes: Vec::new(),
        })
    }

    /// Trains until the epochs are done or patience is out; `after` sees every finished epoch.
    ///
    /// A raised `cancel` stops between batches; the state then stands where it stopped.
    pub(super) fn run(
        &mut self,
        cancel: Option<&AtomicBool>,
        mut after: impl FnMut(&State) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let visited = (self.train.len() as f32 * self.settings.share).ceil() as usize;
        let batches = visited.div_ceil(self.settings.batch);
        let mut order = Vec::new();
        while !self.state.progress.finished {
            let epoch = self.state.progress.history.len();
            order.clear();
            order.extend_from_slice(self.train);
            order.shuffle(&mut generator(self.seed, 1, epoch, 0));
            order.truncate(visited);
            while self.state.progress.batch < batches {
                if cancel.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
                    return Err(Error::Interrupted);
                }
                let from = self.state.progress.batch * self.settings.batch;
                let items = &order[from..order.len().min(from + self.settings.batch)];
                self.step(epoch, batches, items);
                self.state.progress.batch += 1;
            }
            self.end_epoch(epoch)?;
            after(&self.state)?;
        }
        Ok(())
    }

    /// One batch: forward, cost, backward, clip, Adam.
    fn step(&mut self, epoch: usize, batches: usize, items: &[Item]) {
        let settings = self.settings;
        let span = self.gather.layout.span(items.len());
        self.network.begin(span);
        self.gather.inputs(items, &mut self.network);
        let dropout = (settings.dropout > 0.0).then(|| {
            let rng = &mut generator(self.seed, 2, epoch, self.state.progress.batch);
            self.dropout
                .draw(self.architecture, span, settings.dropout, rng);
            &self.dropout
        });
        self.outputs.resize(span.outputs(), 0.0);
        self.network
            .forward(&self.state.parameters, dropout, &mut self.outputs);

        self.slopes.clear();
        let (mut loss, mut total) = (0.0, 0.0);
        for (&y, (_, target, weight)) in self.outputs.iter().zip(self.gather.targets(items)) {
            let (cost, slope) = settings.loss.cost(y - target);
            loss += f64::from(weight) * f64::from(cost);
            total += f64::from(weight);
            self.slopes.push(weight * slope);
        }
        self.state.progress.loss += loss;
        self.state.progress.weight += total;
        if total == 0.0 {
            return;
        }
        let share = (1.0 / total) as f32;
        self.slopes.iter_mut().for_each(|s| *s *= share);
        self.gradient.fill(0.0);
        self.network.backward(
            &self.state.parameters,
            dropout,
            &self.slopes,
            &mut self.gradient,
        );
        let norm = self
            .gradient
            .iter()
            .map(|&g| f64::from(g) * f64::from(g))
            .sum::<f64>()
            .sqrt() as f32;
        let scale = if norm > settings.clip {
            settings.clip / norm
        } else {
            1.0
        };
        let rate = self.rate(epoch, batches);
        self.state.adam.step(
            self.arch,
            &mut self.state.parameters,
            &self.gradient,
            scale,
            rate,
            settings.weight_decay,
        );
    }

    /// Part of all steps that is done.
    fn done(&self, epoch: usize, batches: usize) -> f32 {
        (epoch * batches + self.state.progress.batch) as f32
            / (self.settings.epochs * batches) as f32
    }

    fn rate(&self, epoch: usize, batches: usize) -> f32 {
        let factor = match self.settings.schedule {
            Schedule::Constant => 1.0,
            Schedule::Plateau { .. } => self.state.progress.rate,
            Schedule::Cosine { end } => fall(self.done(epoch, batches), 1.0, end),
            Schedule::OneCycle {
                warm_up,
                start,
                end,
            } => {
                let done = self.done(epoch, batches);
                if done < warm_up {
                    fall(done / warm_up, start, 1.0)
                } else {
                    fall((done - warm_up) / (1.0 - warm_up), 1.0, end)
                }
            }
        };
        self.settings.learning_rate * factor
    }

    /// Scores the epoch, keeps the best weights, decides whether to go on.
    fn end_epoch(&mut self, epoch: usize) -> Result<(), Error> {
        let validation_rmse = (!self.validation.is_empty()).then(|| self.validation_rmse());
        let position = &mut self.state.progress;
        let train_loss = position.loss / position.weight;
        if !train_loss.is_finite() || validation_rmse.is_some_and(|e| !e.is_finite()) {
            return Err(Error::Diverged { epoch: epoch + 1 });
        }
        let best = position
            .history
            .get(position.best_epoch)
            .and_then(|e| e.validation_rmse);
        // Without validation the last epoch counts as the best.
        let improved = match (validation_rmse, best) {
            (Some(now), Some(best)) => now < best,
            _ => true,
        };
        position.history.push(Epoch {
            train_loss,
            validation_rmse,
        });
        (position.batch, position.loss, position.weight) = (0, 0.0, 0.0);
        if improved {
            position.best_epoch = epoch;
            (position.stale, position.plateau) = (0, 0);
            self.state.best.copy_from_slice(&self.state.parameters);
        } else {
            position.stale += 1;
            position.plateau += 1;
        }
        if let Schedule::Plateau { factor, patience } = self.settings.schedule
            && position.plateau > patience
        {
            position.rate *= factor;
            position.plateau = 0;
        }
        position.finished = position.history.len() >= self.settings.epochs
            || position.stale > self.settings.patience;
        Ok(())
    }

    /// Weighted root mean square error of the validation items, N·m.
    fn validation_rmse(&mut self) -> f64 {
        let (mut sum, mut total) = (0.0, 0.0);
        for items in self.validation.chunks(512) {
            let span = self.gather.layout.span(items.len());
            self.network.begin(span);
            self.gather.inputs(items, &mut self.network);
            self.outputs.resize(span.outputs(), 0.0);
            self.network
                .forward(&self.state.parameters, None, &mut self.outputs);
            for (&y, (_, target, weight)) in self.outputs.iter().zip(self.gather.targets(items)) {
                sum += f64::from(weight) * f64::from(y - target).powi(2);
                total += f64::from(weight);
            }
        }
        (sum / total).sqrt() * f64::from(self.gather.target.span()[0])
    }
}

/// Reads a checkpoint where one exists, else `None`.
pub(super) fn resume(
    path: Option<&Path>,
    fingerprint: &str,
    parameters: usize,
) -> Result<Option<State>, Error> {
    match path {
        Some(path) if path.exists() => {
            super::checkpoint::load(path, fingerprint, parameters).map(Some)
        }
        _ => Ok(None),
    }
}

/// Half a cosine from `from` at 0 to `to` at 1.
fn fall(done: f32, from: f32, to: f32) -> f32 {
    to + (from - to) * 0.5 * (1.0 + (std::f32::consts::PI * done).cos())
}
