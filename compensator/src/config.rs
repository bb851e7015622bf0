//! Settings of a unit and of its training, one line each with its default.

use feedforward::network::{Architecture, Fade, Memory, Normalisation, Recurrent};
use serde::{Deserialize, Serialize};

use crate::Error;

/// Loss of one residual, in units of the normalised target.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind", deny_unknown_fields)]
pub enum Loss {
    /// Squared error ½ r² of the residual r.
    Mse,
    /// ½ r² up to |r| = delta, then delta·(|r| − delta/2).
    Huber {
        /// Residual from which the loss is linear.
        delta: f32,
    },
}

/// Schedule of the learning rate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind", deny_unknown_fields)]
pub enum Schedule {
    /// Constant learning rate.
    Constant,
    /// Learning rate that falls along half a cosine over all steps, from the full rate to `end` times it.
    Cosine {
        /// Last learning rate over the first.
        end: f32,
    },
    /// One cycle: up and down along cosines (Smith and Topin, 2019): from `start` to 1 times the rate over the
    /// first part `warm_up` of all steps, then down to `end`.
    OneCycle {
        /// Part of all steps over which the rate rises, in (0, 1).
        warm_up: f32,
        /// First learning rate over the highest.
        start: f32,
        /// Last learning rate over the highest.
        end: f32,
    },
}

/// Settings of the training loop.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Training {
    /// Passes over the training samples, at most (60).
    pub epochs: usize,
    /// Number of samples, or of chunks of carried state, per step (256).
    pub batch: usize,
    /// Part of the training samples, drawn anew, that each epoch visits (1).
    pub share: f32,
    /// AdamW's highest rate, at most 1 (0.002).
    pub learning_rate: f32,
    /// Schedule of the learning rate (cosine to 0.01).
    pub schedule: Schedule,
    /// Decoupled weight decay per step, times the rate (1e-4).
    pub weight_decay: f32,
    /// Share of the encoder's and re-encoder's outputs dropped in training (0.1).
    pub dropout: f32,
    /// Largest Euclidean norm of a gradient (1).
    pub clip: f32,
    /// Cost of a residual (Huber at one deviation).
    pub loss: Loss,
    /// Number of epochs without a better validation error before training stops (12).
    pub patience: usize,
    /// Carried state: samples per chunk through which gradients flow (64).
    pub chunk: usize,
    /// Carried state: number of first samples of a chunk inside a trajectory that only fill the state (16).
    pub fill: usize,
}

impl Default for Training {
    fn default() -> Self {
        Self {
            epochs: 60,
            batch: 256,
            share: 1.0,
            learning_rate: 0.002,
            schedule: Schedule::Cosine { end: 0.01 },
            weight_decay: 1e-4,
            dropout: 0.1,
            clip: 1.0,
            loss: Loss::Huber { delta: 1.0 },
            patience: 12,
            chunk: 64,
            fill: 16,
        }
    }
}

impl Training {
    /// Training loop of all units but the published one: small batches of squared error, one cycle of the rate, no dropout, every
    /// epoch gone through. `share` of the samples are visited by an epoch, at most all.
    pub fn one_cycle(epochs: usize, learning_rate: f32, share: f32) -> Self {
        Self {
            epochs,
            batch: 128,
            share: share.min(1.0),
            learning_rate,
            schedule: Schedule::OneCycle {
                warm_up: 0.15,
                start: 0.1,
                end: 1e-3,
            },
            dropout: 0.0,
            loss: Loss::Mse,
            patience: epochs,
            ..Self::default()
        }
    }
}

/// All settings of a unit's training, except data and seeds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnitConfig {
    /// Architecture of the network (LSTM 32, attention 32, LSTM 32 on windows of 3).
    pub architecture: Architecture,
    /// Scaling of inputs and target (z-score).
    pub normalisation: Normalisation,
    /// Fade of its output outside the training inputs.
    pub fade: Fade,
    /// Number of networks trained from different seeds whose outputs are averaged (1).
    pub members: usize,
    /// Share by which the validation error must at least fall, or the unit is switched off (0.01).
    pub least_gain: f32,
    /// Number of standard errors over the validation trajectories by which the error must fall as well (2): a gain by
    /// chance does harm where the torque is used.
    pub sure: f32,
    /// Settings of the training loop.
    pub training: Training,
}

/// Recurrent architecture on windows of `timestep` samples, with `width` units in encoder, attention and re-encoder.
fn recurrent(width: usize, timestep: usize) -> Architecture {
    Architecture::Recurrent(Recurrent {
        encoder: width,
        attention: Some(width),
        reencoder: width,
        memory: Memory::Window { timestep },
    })
}

impl Default for UnitConfig {
    fn default() -> Self {
        Self {
            architecture: recurrent(32, 3),
            normalisation: Normalisation::ZScore,
            fade: Fade::default(),
            members: 1,
            least_gain: 0.01,
            sure: 2.0,
            training: Training::default(),
        }
    }
}

impl UnitConfig {
    /// Settings of the unit that Wang et al. publish: 128 + 128, windows of 3, min–max scaling, squared error.
    ///
    /// The paper gives Adam a rate of 0.05 and dropout 0.5; less of both left less error on held-out
    /// trajectories of the simulated UR5: 0.003, falling by a cosine, and 0.1.
    pub fn ucm() -> Self {
        Self {
            architecture: recurrent(128, 3),
            normalisation: Normalisation::MinMax,
            training: Training {
                batch: 128,
                learning_rate: 0.003,
                weight_decay: 0.0,
                dropout: 0.1,
                loss: Loss::Mse,
                epochs: 20,
                ..Training::default()
            },
            ..Self::default()
        }
    }

    /// Refuses settings that cannot work.
    ///
    /// # Errors
    /// [`Error::Config`] naming the field.
    pub fn check(&self) -> Result<(), Error> {
        let t = &self.training;
        let positive = |x: f32| x > 0.0 && x.is_finite();
        let share = |x: f32| (0.0..=1.0).contains(&x);
        let refuse = |setting, problem: &str| {
            Err(Error::Config {
                setting,
                problem: problem.into(),
            })
        };
        match () {
            () if self.members == 0 => refuse("members", "at least one network is needed"),
            () if t.epochs == 0 => refuse("epochs", "at least one pass is needed"),
            () if t.batch == 0 => refuse("batch", "at least one sample is needed"),
            () if !(t.share > 0.0 && t.share <= 1.0) => refuse("share", "must be in (0, 1]"),
            () if !(t.learning_rate > 0.0 && t.learning_rate <= 1.0) => {
                refuse("learning_rate", "must be in (0, 1]")
            }
            () if !(0.0..1.0).contains(&t.dropout) => refuse("dropout", "must be in [0, 1)"),
            () if !positive(t.clip) => refuse("clip", "must be positive"),
            () if !(t.weight_decay >= 0.0 && t.weight_decay.is_finite()) => {
                refuse("weight_decay", "must not be negative")
            }
            () if t.chunk <= t.fill => refuse("chunk", "must be longer than `fill`"),
            () if !(self.fade.start >= 0.0
                && self.fade.end > self.fade.start
                && self.fade.end.is_finite()) =>
            {
                refuse("fade", "must start at 0 or above and end later")
            }
            () if matches!(t.loss, Loss::Huber { delta } if !positive(delta)) => {
                refuse("loss.delta", "must be positive")
            }
            () if matches!(t.schedule, Schedule::Cosine { end } if !share(end)) => {
                refuse("schedule.end", "must be in [0, 1]")
            }
            () if matches!(t.schedule, Schedule::OneCycle { warm_up, .. } if !(warm_up > 0.0 && warm_up < 1.0)) => {
                refuse("schedule.warm_up", "must be in (0, 1)")
            }
            () if matches!(t.schedule, Schedule::OneCycle { start, end, .. } if !(share(start) && share(end))) => {
                refuse("schedule", "`start` and `end` must be in [0, 1]")
            }
            () if self
                .architecture
                .parameter_count(1)
                .is_none_or(|n| n > 1 << 28) =>
            {
                refuse(
                    "architecture",
                    "every width must be positive and the network below 268 million parameters",
                )
            }
            () => Ok(()),
        }
    }
}
