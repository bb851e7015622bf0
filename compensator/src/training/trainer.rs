//! The loop that trains one network from one seed.

use std::sync::atomic::{AtomicBool, Ordering};

use feedforward::network::Architecture;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::batches::{Gatherer, Item};
use super::epoch::{Epoch, Position};
use super::state::State;
use crate::Error;
use crate::config::Training;
use crate::engine::Network;
use crate::learning::{Batch, Learner, Means, NotFinite, Tensors, Weights};

/// Training of one network.
pub(super) struct Trainer<'a, 'd> {
    /// Source of the batches.
    gather: &'a Gatherer<'a, 'd>,
    /// Architecture of the network.
    architecture: &'a Architecture,
    /// Settings of the training loop.
    settings: &'a Training,
    /// Seed of all random numbers of this network.
    seed: u64,
    /// Windows or chunks that are fitted.
    train: &'a [Item],
    /// Windows or chunks that decide when training stops.
    validation: &'a [Item],
    /// Buffers of one batch.
    batch: Batch,
    /// State that changes from step to step.
    pub(super) state: State,
}

/// Random generator for one purpose, epoch and batch; all of them are independent.
fn generator(seed: u64, purpose: u8, epoch: usize, batch: usize) -> ChaCha8Rng {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(&(epoch as u64).to_le_bytes());
    key[16..24].copy_from_slice(&(batch as u64).to_le_bytes());
    key[24] = purpose;
    ChaCha8Rng::from_seed(key)
}

/// Number of samples that an epoch visits, and number of steps that it takes.
fn epoch_size(settings: &Training, samples: usize) -> (usize, usize) {
    let visited = (samples as f32 * settings.share).ceil() as usize;
    (visited, visited.div_ceil(settings.batch))
}

impl<'a, 'd> Trainer<'a, 'd> {
    /// Training of a new network whose output starts at `level` (normalised), by the kernels or by `tensors`.
    ///
    /// # Errors
    /// Settings that cannot work.
    pub(super) fn new(
        gather: &'a Gatherer<'a, 'd>,
        (architecture, settings): (&'a Architecture, &'a Training),
        (train, validation): (&'a [Item], &'a [Item]),
        (seed, level): (u64, f32),
        tensors: Option<&Tensors>,
    ) -> Result<Self, Error> {
        let inputs = gather.columns.len();
        let network = Network::new(architecture, inputs).ok_or_else(|| Error::Config {
            setting: "architecture",
            problem: "a width is zero or absurdly large".into(),
        })?;
        let rng = &mut generator(seed, 0, 0, 0);
        let weights = Weights::initial(architecture, inputs, level, rng);
        let (_, batches) = epoch_size(settings, train.len());
        let steps = settings.epochs * batches;
        let means = tensors.map(|tensors| Means {
            tensors: tensors.clone(),
            architecture: architecture.clone(),
            inputs,
        });
        let learner = Learner::new(weights, settings, steps, means).map_err(|problem| {
            let setting = "training";
            Error::Config { setting, problem }
        })?;
        let best = learner.weights().clone();
        Ok(Self {
            gather,
            architecture,
            settings,
            seed,
            train,
            validation,
            batch: Batch::new(network, settings.loss),
            state: State {
                learner,
                best,
                progress: Position::default(),
            },
        })
    }

    /// Trains until all epochs are done, or none of the last ones improved the validation error. `after` is called
    /// after every epoch.
    ///
    /// A raised `cancel` ends the training between batches, and the state stays as it is there.
    pub(super) fn run(
        &mut self,
        cancel: Option<&AtomicBool>,
        mut after: impl FnMut(&State) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let (visited, batches) = epoch_size(self.settings, self.train.len());
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
                self.step(epoch, items)?;
                self.state.progress.batch += 1;
            }
            self.end_epoch(epoch)?;
            after(&self.state)?;
        }
        Ok(())
    }

    /// Writes inputs and targets of the items into the batch.
    fn fill(&mut self, items: &[Item]) {
        self.batch.begin(self.gather.layout.span(items.len()));
        self.gather.inputs(items, &mut self.batch.network);
        let targets = self.gather.targets(items);
        self.batch
            .targets
            .extend(targets.map(|(_, target, weight)| (target, weight)));
    }

    /// Trains on one batch: cost, gradient, optimiser step.
    fn step(&mut self, epoch: usize, items: &[Item]) -> Result<(), Error> {
        self.fill(items);
        if self.batch.weight() == 0.0 {
            self.state.learner.skip();
            return Ok(());
        }
        if self.settings.dropout > 0.0 {
            let rng = &mut generator(self.seed, 2, epoch, self.state.progress.batch);
            let span = self.gather.layout.span(items.len());
            let dropout = self.batch.dropout.get_or_insert_default();
            dropout.draw(self.architecture, span, self.settings.dropout, rng);
        }
        let cost = self
            .state
            .learner
            .step(&mut self.batch)
            .map_err(|quantity| Error::Diverged {
                epoch: epoch + 1,
                what: match quantity {
                    NotFinite::Loss => "loss",
                    NotFinite::Gradient => "gradient",
                },
            })?;
        self.state.progress.loss += cost.sum;
        self.state.progress.weight += cost.weight;
        Ok(())
    }

    /// Scores the epoch, keeps the best weights, decides whether to go on.
    fn end_epoch(&mut self, epoch: usize) -> Result<(), Error> {
        let validation_rmse = (!self.validation.is_empty()).then(|| self.validation_rmse());
        let position = &mut self.state.progress;
        let train_loss = position.loss / position.weight;
        let diverged = |what| Error::Diverged {
            epoch: epoch + 1,
            what,
        };
        if !train_loss.is_finite() {
            return Err(diverged("loss"));
        }
        if validation_rmse.is_some_and(|e| !e.is_finite()) {
            return Err(diverged("validation error"));
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
            (position.best_epoch, position.stale) = (epoch, 0);
            self.state.best = self.state.learner.weights().clone();
        } else {
            position.stale += 1;
        }
        position.finished = position.history.len() >= self.settings.epochs
            || position.stale > self.settings.patience;
        Ok(())
    }

    /// Weighted root mean square error of the validation items, N·m.
    fn validation_rmse(&mut self) -> f64 {
        let parameters = self.state.learner.weights().values();
        let (mut sum, mut total) = (0.0, 0.0);
        for items in self.validation.chunks(512) {
            self.fill(items);
            let (outputs, targets) = self.batch.outputs(&parameters);
            for (&y, &(target, weight)) in outputs.iter().zip(targets) {
                sum += f64::from(weight) * f64::from(y - target).powi(2);
                total += f64::from(weight);
            }
        }
        (sum / total).sqrt() * f64::from(self.gather.target.span()[0])
    }
}
