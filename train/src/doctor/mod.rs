//! `train doctor`: how often the torque channel's doctor is right, on simulated recordings of every kind.

mod arguments;
mod outcome;
mod tables;

pub use arguments::Doctor;

use crate::progress;
use crate::runtime::{pool, stop};
use model::directory::json;
use model::failure::Failure;
use outcome::{Counted, Figures, Kind, Outcome};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use trials::channels::Fault;

/// Name and version of the JSON format.
const SCHEMA: &str = "doctor/1";

/// Runs the command.
///
/// # Errors
/// The interruption, a simulation without result, or a file that cannot be written.
pub fn run(arguments: &Doctor, cancel: &AtomicBool) -> Result<(), Failure> {
    let counted = pool(&arguments.running)?.install(|| count(arguments, cancel))?;
    let figures = Figures {
        schema: SCHEMA,
        seed: arguments.seed,
        kinds: counted,
    };
    if let Some(path) = &arguments.json {
        report::write_atomic(path, json(&figures))?;
    }
    if !arguments.running.quiet {
        tables::print(&figures, arguments.verbose);
    }
    Ok(())
}

fn count(arguments: &Doctor, cancel: &AtomicBool) -> Result<Vec<Counted>, Failure> {
    let kinds: Vec<Kind> = Kind::all()
        .filter(|f| arguments.only.as_ref().is_none_or(|only| only == f.name()))
        .collect();
    let number = |kind: Kind| match kind {
        Kind::Channel(Fault::None) => arguments.healthy,
        Kind::Channel(_) => arguments.cases,
        Kind::Description(_) => arguments.wrong_descriptions,
    };
    let all: u64 = kinds.iter().map(|f| number(*f)).sum();
    let bar = progress::bar(arguments.running.quiet, "examining");
    let done = AtomicU64::new(0);
    let one = |fault: Kind, index: u64| -> Result<Outcome, Failure> {
        stop(cancel, "Nothing was written.")?;
        let outcome = Outcome::of(fault, arguments.seed, index)?;
        let so_far = done.fetch_add(1, Ordering::Relaxed) + 1;
        bar.set_position(100 * so_far / all.max(1));
        Ok(outcome)
    };
    let counted = kinds
        .iter()
        .map(|&fault| {
            let outcomes = (0..number(fault))
                .into_par_iter()
                .map(|index| one(fault, index))
                .collect::<Result<_, _>>()?;
            Ok(Counted::new(fault, outcomes))
        })
        .collect();
    bar.finish_and_clear();
    counted
}
