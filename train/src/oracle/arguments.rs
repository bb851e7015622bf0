//! Command line of `train oracle`.

use clap::Args;
use program::Running;
use std::path::PathBuf;

/// For a model that `train` made of a simulated robot: scores of the true plant on the held-out recording, and what the model
/// leaves of each mechanism.
#[derive(Debug, Args)]
pub struct Oracle {
    /// Model directory, written by `train` without --data.
    #[arg(long, default_value = "residyn-model")]
    pub model: PathBuf,
    /// Write the figures as JSON.
    #[arg(long)]
    pub json: Option<PathBuf>,
    /// How it runs.
    #[command(flatten)]
    pub running: Running,
}
