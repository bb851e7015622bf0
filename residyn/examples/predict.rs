//! A stored model over a whole recording: torque with its deviation, and scores, as `residyn eval` has them.
//!
//! `cargo run --release -p residyn --example predict`

use residyn::model::evaluation::{EvaluateOptions, evaluate};
use residyn::trials::protocols::payload::{LoadedArm, loaded};
use residyn::{FitOptions, ModelFile, fit_physics};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let made = loaded(LoadedArm::Ur5, true, 13)?;
    let (train, test) = made.without.split(&[3]);
    let folder = tempfile::tempdir()?;
    fit_physics(&made.robot, &[train], None, &FitOptions::basic())?
        .file
        .save(folder.path())?;

    let file = ModelFile::load(folder.path())?;
    let tau = test.tau.clone().ok_or("the recording has torque")?;
    let done = evaluate(folder.path(), &file, test, &EvaluateOptions::default())?;
    for row in &done.report.rows {
        println!("{:<16} {:?}: {:.4?}", row.name, row.scope, row.scores.nrmse);
    }
    // How much of the recorded torque lies within two deviations of the predicted one.
    let close = |((i, j), tau): ((usize, usize), &f64)| {
        (tau - done.torque[[i, j]]).abs() < 2.0 * done.deviation[[i, j]]
    };
    let inside = tau.indexed_iter().filter(|&at| close(at)).count() as f64 / tau.len() as f64;
    println!("within two deviations: {:.1} %", 100.0 * inside);
    assert!(inside > 0.85);
    Ok(())
}
