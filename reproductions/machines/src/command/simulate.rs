//! `machine simulate`.

use crate::MachineError;
use crate::description::Description;
use crate::plant::{Carried, Options, simulate};
use report::say;
use std::path::PathBuf;

/// What to simulate.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Machine: a built-in name, or a description (.toml) with a table `[motion]`.
    #[arg(long)]
    robot: String,
    /// Folder for NAME-identification and NAME-heldout.
    #[arg(long)]
    out: PathBuf,
    /// Torque model whose machine is simulated (a crank that turns upright, coupled axes, …) [default: the description's].
    #[arg(long)]
    dynamic_model: Option<usize>,
    /// Format: parquet or csv.
    #[arg(long, default_value = "parquet", value_parser = ["parquet", "csv"])]
    format: String,
    /// Seed.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Deviation of the torque noise over the RMS of each axis's torque.
    #[arg(long, default_value_t = 0.01)]
    noise: f64,
    /// Length of each recording, s.
    #[arg(long, default_value_t = 20.0)]
    seconds: f64,
    /// Samples per second.
    #[arg(long, default_value_t = 1000.0)]
    rate: f64,
    /// Factor on the frequencies of the described motion.
    #[arg(long, default_value_t = 1.0)]
    pace: f64,
    /// Factor on the spans of the described motion.
    #[arg(long, default_value_t = 1.0)]
    span: f64,
    /// Wrong torque factor: the recorded torque of an axis times a number.
    #[arg(long, value_name = "AXIS=FACTOR", value_parser = super::of_axis)]
    factor: Vec<(usize, f64)>,
    /// Saturation: the recorded torque of an axis is cut at this.
    #[arg(long, value_name = "AXIS=LIMIT", value_parser = super::of_axis)]
    limit: Vec<(usize, f64)>,
    /// The machine as its model idealises it: a Delta's forearms as points at their ends.
    #[arg(long)]
    ideal: bool,
    /// A body on the last axis: its mass, kg, and inertia, kg·m².
    #[arg(long, value_name = "MASS[,INERTIA]", value_parser = super::body)]
    payload: Option<Carried>,
}

/// Simulates and writes both recordings.
pub fn run(arguments: &Arguments) -> Result<(), MachineError> {
    let mut description = Description::load(&arguments.robot)?;
    if let Some(number) = arguments.dynamic_model {
        description.dynamic_model = number;
        description.check()?;
    }
    let options = Options {
        seed: arguments.seed,
        noise: arguments.noise,
        seconds: arguments.seconds,
        rate: arguments.rate,
        pace: arguments.pace,
        span: arguments.span,
        factors: arguments.factor.clone(),
        limits: arguments.limit.clone(),
        ideal: arguments.ideal,
        carried: arguments.payload.unwrap_or_default(),
    };
    let recordings = simulate(&description, &options)?;
    super::folder(&arguments.out)?;
    for (recording, part) in recordings.iter().zip(["identification", "heldout"]) {
        let name = format!("{}-{part}.{}", description.name, arguments.format);
        let path = arguments.out.join(name);
        datasets::write(recording, &path)?;
        say!("{}", path.display());
    }
    Ok(())
}
