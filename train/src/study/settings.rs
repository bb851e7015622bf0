//! Size and duration of the study.

use super::data::Data;
use compensator::training::{Fold, Training, UnitConfig, folds};
use model::failure::Failure;
use model::residual::ResidualError;

/// Number of samples that RLOESS smooths over: a quarter of a second of the moves. The UR5 paper does not state its
/// span.
pub const SPAN: usize = 15;

/// Number of samples of which one is held out where they are dealt out singly: 80 to 20 %, as in the UR5 paper.
pub const DEALT: usize = 5;

/// Advice after an interruption.
pub const GO_ON: &str = "Run the same command again: what is trained is kept.";

/// Settings that all trials share.
pub struct Settings {
    /// Folds that are run. The comparisons beside Table 6 run the first one alone.
    pub folds: Vec<Fold>,
    /// Width of encoder, attention and re-encoder.
    pub hidden: usize,
    /// Hidden nodes of the comparison of fully connected with LSTM.
    pub nodes: Vec<usize>,
    /// Number of windows that an epoch visits.
    pub windows: usize,
    /// Settings of the training loop.
    pub training: Training,
    /// Seed of the networks' weights.
    pub seed: u64,
    /// Number of networks of different seeds that the comparisons on the first fold average.
    pub repeats: u64,
}

impl Settings {
    /// The published sizes on five folds, or small ones on one.
    pub fn new(quick: bool, data: &Data, seed: u64) -> Result<Self, Failure> {
        let mut folds = folds(&data.moves.motions, 5, seed).map_err(ResidualError::from)?;
        let fitted: usize = folds[0]
            .split
            .train
            .iter()
            .map(|&t| data.moves.segments[t].len())
            .sum();
        let windows = if quick { 12_000 } else { 30_000 };
        let published = UnitConfig::ucm().training;
        let training = Training {
            share: (windows as f32 / fitted as f32).min(1.0),
            ..if quick {
                // Small units learn faster and memorise less.
                Training {
                    epochs: 24,
                    learning_rate: 0.01,
                    dropout: 0.0,
                    ..published
                }
            } else {
                published
            }
        };
        if quick {
            folds.truncate(1);
        }
        Ok(Self {
            folds,
            hidden: if quick { 32 } else { 128 },
            nodes: if quick {
                vec![4, 8, 16, 32]
            } else {
                vec![8, 16, 32, 64, 128]
            },
            windows,
            training,
            seed,
            repeats: if quick { 1 } else { 3 },
        })
    }
}
