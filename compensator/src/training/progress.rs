//! Progress of a training.

use super::epoch::{Epoch, Position};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Progress of one network's training, with the time left for all networks.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress {
    /// Index of the training job.
    pub job: usize,
    /// Joint whose unit the job trains, from 0.
    pub joint: usize,
    /// Index of the job's network, from 0.
    pub member: usize,
    /// Finished epochs of this network.
    pub epoch: usize,
    /// Largest number of epochs.
    pub epochs: usize,
    /// Errors after the last finished epoch.
    pub last: Epoch,
    /// Smallest validation error so far, N·m; none without validation trajectories.
    pub best_validation_rmse: Option<f64>,
    /// Whether the training of this network has ended.
    pub finished: bool,
    /// Time left for all networks, if every one trains to its last epoch.
    pub remaining: Duration,
}

/// Amount of work of one network's training.
struct Network {
    /// Cost of an epoch: samples × parameters.
    cost: f64,
    /// Largest number of epochs.
    epochs: usize,
    /// Number of epochs left.
    left: usize,
    /// Number of epochs trained in this run, not taken from a checkpoint.
    done: usize,
}

/// Estimate of the time that a training still takes, from the epochs done.
pub struct Clock {
    started: Instant,
    networks: Mutex<Vec<Network>>,
}

impl Clock {
    /// Estimate for networks with these costs of an epoch and largest numbers of epochs.
    pub fn new(networks: impl Iterator<Item = (f64, usize)>) -> Self {
        let networks = networks.map(|(cost, epochs)| Network {
            cost,
            epochs,
            left: epochs,
            done: 0,
        });
        Self {
            started: Instant::now(),
            networks: Mutex::new(networks.collect()),
        }
    }

    /// Records the position of a network after an epoch or, with `kept`, as its checkpoint had it. Returns the
    /// time left for all networks, zero before anything was trained in this run.
    pub fn note(&self, index: usize, position: &Position, kept: bool) -> Duration {
        let mut networks = self
            .networks
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner());
        let network = &mut networks[index];
        network.done += usize::from(!kept);
        network.left = if position.finished {
            0
        } else {
            network.epochs.saturating_sub(position.history.len())
        };
        let (mut ahead, mut behind) = (0.0, 0.0);
        for network in networks.iter() {
            ahead += network.cost * network.left as f64;
            behind += network.cost * network.done as f64;
        }
        if behind > 0.0 {
            self.started.elapsed().mul_f64(ahead / behind)
        } else {
            Duration::ZERO
        }
    }
}
