//! `decoupled simulate`.

use super::{axis, json};
use crate::DecoupledError;
use crate::comau::columns;
use crate::reference::{Reference, Shuttle};
use crate::simulation::{Setup, simulate};
use crate::study::{BANG_BANG, SECONDS, SLOPES, WAYS, excitation};
use report::say;
use std::path::PathBuf;

/// Which axis, where to.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Axis of the simulated COMAU Smart-3 S2, from 1.
    #[arg(long, default_value_t = 3)]
    axis: usize,
    /// Folder to write into.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Seed of excitation and noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Simulates and writes periodic.parquet, bang-bang.parquet, slopes.parquet and truth.json.
pub fn run(arguments: &Arguments) -> Result<(), DecoupledError> {
    let joint = axis(arguments.axis)?;
    let folder = &arguments.out;
    std::fs::create_dir_all(folder).map_err(|source| DecoupledError::Folder {
        path: folder.clone(),
        source,
    })?;
    let (series, _) = excitation(columns(&joint), arguments.seed ^ arguments.axis as u64)?;
    let shuttle = |motion: Shuttle, ways: f64| (Reference::Shuttle(motion), ways * motion.period());
    let runs = [
        ("periodic", (Reference::Periodic(series), SECONDS)),
        ("bang-bang", shuttle(BANG_BANG, WAYS[1])),
        ("slopes", shuttle(SLOPES, WAYS[0])),
    ];
    for (k, (name, (reference, seconds))) in runs.into_iter().enumerate() {
        let seed = arguments.seed.wrapping_mul(4).wrapping_add(k as u64);
        let trace = simulate(&joint, &reference, seconds, &Setup::default(), None, seed);
        let path = folder.join(format!("{name}.parquet"));
        datasets::write(&trace.run.recording(), &path)?;
        say!("{}", path.display());
    }
    let path = folder.join("truth.json");
    report::write_atomic(&path, json(&joint))?;
    say!("{}", path.display());
    Ok(())
}
