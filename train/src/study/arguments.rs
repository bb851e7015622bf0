//! Command line of `train study`.

use clap::Args;
use std::path::PathBuf;

/// Reprints the published comparisons on the simulated UR5: Tables 6–8, input sets, timesteps, and
/// fully connected against LSTM.
#[derive(Debug, Args)]
pub struct Study {
    /// Seed of the simulation, the folds and the networks.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Smaller units, fewer passes, one fold: a few minutes instead of half an hour.
    #[arg(long)]
    pub quick: bool,
    /// Write the figures as JSON.
    #[arg(long)]
    pub json: Option<PathBuf>,
    /// Folder that keeps the simulated recordings.
    #[arg(long, default_value = "residyn-model/simulated")]
    pub cache: PathBuf,
    /// Threads; the result does not depend on it [default: all cores].
    #[arg(long)]
    pub threads: Option<usize>,
    /// Print nothing but errors.
    #[arg(long)]
    pub quiet: bool,
}
