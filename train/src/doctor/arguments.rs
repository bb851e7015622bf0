//! Command line of `train doctor`.

use super::outcome::Kind;
use clap::Args;
use clap::builder::PossibleValuesParser;
use program::Running;
use std::path::PathBuf;

/// Examines the torque channels of simulated recordings with one fault each, and of healthy ones, and counts what is
/// recognised and what its remedies mend.
#[derive(Debug, Args)]
pub struct Doctor {
    /// Number of recordings with each fault.
    #[arg(long, default_value_t = 20)]
    pub cases: u64,
    /// Number of healthy recordings.
    #[arg(long, default_value_t = 200)]
    pub healthy: u64,
    /// Number of healthy recordings checked against each kind of wrong description.
    #[arg(long, value_name = "CASES", default_value_t = 20)]
    pub wrong_descriptions: u64,
    /// Seed of robots, motions and channels.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Examine this kind only; `none` is the healthy recordings.
    #[arg(long, value_parser = PossibleValuesParser::new(Kind::all().map(Kind::name)))]
    pub only: Option<String>,
    /// Write every outcome as JSON.
    #[arg(long)]
    pub json: Option<PathBuf>,
    /// Print every recording with a wrong answer.
    #[arg(long, conflicts_with = "quiet")]
    pub verbose: bool,
    /// How it runs.
    #[command(flatten)]
    pub running: Running,
}
