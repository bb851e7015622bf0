//! Command line of `train forward`.

use clap::Args;
use program::Running;
use std::path::PathBuf;

/// Teaches a model the forward task: positions from torque, by solving the identified model for the motion. Writes
/// `forward.json` into the model directory, from which `eval` then makes its row `physics_forward`.
#[derive(Debug, Args)]
pub struct Forward {
    /// Model directory, written by `train` on the same recordings.
    #[arg(long, default_value = "residyn-model")]
    pub model: PathBuf,
    /// Recordings to learn motions and friction from: many trajectories of one length.
    #[arg(long, num_args = 1.., required = true)]
    pub data: Vec<PathBuf>,
    /// Drive file of the recordings.
    #[arg(long)]
    pub drive: Option<PathBuf>,
    /// Number of folds, each of whole groups of trajectories, left out in turn to score the result. 0 skips the
    /// scoring.
    #[arg(long, default_value_t = 4)]
    pub folds: usize,
    /// How it runs.
    #[command(flatten)]
    pub running: Running,
}
