//! Command line of `train study`.

use clap::Args;
use program::Running;
use std::path::PathBuf;

/// Reprints the published comparisons on the simulated UR5: Tables 6–8, input sets, timesteps, and
/// fully connected against LSTM, and the paper's own way of smoothing and splitting.
#[derive(Debug, Args)]
pub struct Study {
    /// Seed of the simulation, the folds and the networks.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Smaller units, fewer passes, one fold, one seed: a few minutes instead of an hour or two.
    #[arg(long)]
    pub quick: bool,
    /// Write the figures as JSON.
    #[arg(long)]
    pub json: Option<PathBuf>,
    /// Folder that keeps the simulated recordings.
    #[arg(long, default_value = "residyn-model/simulated")]
    pub cache: PathBuf,
    /// Folder that keeps the networks until the study is complete: the same command goes on from them.
    #[arg(long, default_value = "residyn-model/study")]
    pub checkpoints: PathBuf,
    /// How it runs.
    #[command(flatten)]
    pub running: Running,
}
