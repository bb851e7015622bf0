//! `eval --closed-loop`: tracking of a simulated closed loop with the model as feed-forward.

use crate::arguments::{Arguments, WIDTH};
use control::demonstration::{compared, errors, of_directory, page, standard};
use model::directory::{ModelFile, json};
use model::failure::Failure;
use report::{say, say_text};

/// Seed of the Fourier motion.
const SEED: u64 = 1;

/// Runs the closed loop, writes its files and prints the table.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let made = match &arguments.model {
        Some(directory) => {
            let file = ModelFile::load(directory)?;
            of_directory(directory, &file, arguments.withheld.into(), SEED)?
        }
        None => standard()?,
    };
    if let Some(path) = &arguments.json {
        report::write_atomic(path, json(&made))?;
    }
    if let Some(path) = &arguments.html {
        report::write_atomic(path, page(&made).render())?;
    }
    if arguments.quiet {
        return Ok(());
    }
    for experiment in &made.experiments {
        say_text!(errors(experiment).to_text());
        say!();
    }
    if let Some(table) = compared(&made) {
        say_text!(table.to_text());
        say!();
    }
    say!("RMS errors of the motor positions in mrad (mm where a joint slides).");
    for note in &made.notes {
        say_text!(report::wrapped(note, WIDTH, ""));
    }
    Ok(())
}
