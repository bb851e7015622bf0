//! `train oracle`: error of a simulated robot's model against the least attainable one.

mod arguments;
mod cutoffs;
mod figures;
mod mechanisms;
mod plant;
mod tables;

pub use arguments::Oracle;
pub(crate) use cutoffs::at_best_cutoff;
pub(crate) use plant::true_torque;

use crate::runtime::pool;
use figures::Figures;
use model::directory::{ModelFile, json};
use model::evaluation::{EvaluateOptions, evaluate};
use model::failure::Failure;
use plant::Plant;

/// Runs the command.
///
/// # Errors
/// A model of no simulated robot, or files that cannot be read or written.
pub fn run(arguments: &Oracle) -> Result<(), Failure> {
    pool(&arguments.running)?.install(|| steps(arguments))
}

fn steps(arguments: &Oracle) -> Result<(), Failure> {
    let file = ModelFile::load(&arguments.model)?;
    let plant = Plant::of(&file, arguments)?;
    let options = EvaluateOptions::default();
    let evaluation = evaluate(&arguments.model, &file, plant.recording.clone(), &options)?;
    let attainable = plant.attainable(&file, &evaluation)?;
    let left = mechanisms::left(&arguments.model, &file, &plant, &evaluation)?;
    let figures = Figures::new(&file, &plant, &evaluation, attainable, left)?;
    if let Some(path) = &arguments.json {
        report::write_atomic(path, json(&figures))?;
    }
    if !arguments.running.quiet {
        tables::print(&figures);
    }
    Ok(())
}
