//! How far a training is.

use super::state::{Epoch, State};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// State of one network, and an estimate for all of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress {
    /// Index of the job.
    pub job: usize,
    /// Joint of the job.
    pub joint: usize,
    /// Which of the job's networks, from 0.
    pub member: usize,
    /// Finished epochs of this network.
    pub epoch: usize,
    /// Most epochs it may take.
    pub epochs: usize,
    /// The epoch's figures.
    pub last: Epoch,
    /// Smallest validation error so far, N·m.
    pub best_validation_rmse: Option<f64>,
    /// Whether this network is done.
    pub finished: bool,
    /// Time left for all networks, if none stops early.
    pub remaining: Duration,
}

/// Estimates the time left from epochs done, each weighted by samples × parameters.
pub struct Clock {
    started: Instant,
    /// Per network: cost of an epoch, epochs left, epochs done here.
    left: Mutex<Vec<(f64, usize, usize)>>,
}

impl Clock {
    /// From the cost of an epoch of each network and the most epochs that it may take.
    pub fn new(networks: impl Iterator<Item = (f64, usize)>) -> Self {
        let left = networks.map(|(cost, epochs)| (cost, epochs, 0));
        Self {
            started: Instant::now(),
            left: Mutex::new(left.collect()),
        }
    }

    /// Notes an epoch of a network, whose state now is `state`; time left for all of them.
    pub fn epoch_done(&self, index: usize, state: &State) -> Duration {
        let mut left = self
            .left
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner());
        let (_, epochs, done) = &mut left[index];
        *done += 1;
        *epochs = if state.progress.finished {
            0
        } else {
            epochs.saturating_sub(1)
        };
        let (mut ahead, mut behind) = (0.0, 0.0);
        for &(cost, epochs, done) in left.iter() {
            ahead += cost * epochs as f64;
            behind += cost * done as f64;
        }
        self.started.elapsed().mul_f64(ahead / behind)
    }
}
