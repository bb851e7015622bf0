//! `train forward`: positions from torque, by the identified model.

mod arguments;

pub use arguments::Forward;

use crate::progress;
use crate::runtime::{pool, stop};
use datasets::folds::Folds;
use datasets::metrics::{Row, Scores};
use datasets::{Part, Recording, read};
use model::directory::{FORWARD, ModelFile};
use model::evaluation::read_options;
use model::failure::Failure;
use model::inversion::{Inversion, PHYSICS_FORWARD};
use model::loaded::Loaded;
use model::residual;
use ndarray::{Array2, Axis, concatenate};
use report::{Cell, Column, Table, say, say_text};
use signal::Motion;
use std::sync::atomic::AtomicBool;

/// Runs the command until it is done or `cancel` is raised.
///
/// # Errors
/// A model or recordings that cannot be used, or the interruption.
pub fn run(arguments: &Forward, cancel: &AtomicBool) -> Result<(), Failure> {
    pool(&arguments.running)?.install(|| steps(arguments, cancel))
}

fn steps(arguments: &Forward, cancel: &AtomicBool) -> Result<(), Failure> {
    if arguments.folds == 1 {
        return Err(Failure::input(
            "--folds 1: nothing would be left to learn from",
            "Give two or more, or 0 to leave the judging out.",
        ));
    }
    let file = ModelFile::load(&arguments.model)?;
    let checksum = ModelFile::sha256(&arguments.model)?;
    let options = read_options(&file, arguments.drive.as_deref(), Part::Train, true)?;
    let mut data: Vec<(Recording, Motion)> = Vec::new();
    for path in &arguments.data {
        let recording = read(path, &options).map_err(|e| Failure::input(e.to_string(), ""))?;
        if recording.dof() != file.joints.len() {
            let (found, wanted) = (recording.dof(), file.joints.len());
            return Err(Failure::input(
                format!("{}: {found} joints, the model has {wanted}", path.display()),
                "Give recordings of the model's robot.",
            ));
        }
        let prepared = file.preprocessing.prepare(&recording, None);
        let prepared = prepared.map_err(|e| Failure::input(e.to_string(), ""))?;
        data.push((recording, prepared.at_samples));
    }
    let model = file
        .physics
        .model()
        .map_err(|e| Failure::input(e.to_string(), ""))?;
    let compensator = residual::load(&arguments.model, &file)?;
    let whole = Loaded {
        file: &file,
        model: &model,
        compensator: compensator.as_ref(),
    };
    let all: Vec<(&Recording, &Motion)> = data.iter().map(|(r, m)| (r, m)).collect();
    let inversion = Inversion::learn(&model, &all)?;
    let judged = judge(&whole, &data, arguments, cancel)?;
    inversion.save(&arguments.model, &checksum)?;
    if !arguments.running.quiet {
        let (shapes, samples) = (inversion.prior.shapes.len(), inversion.prior.samples());
        say!("Motions of {samples} samples are made of {shapes} shapes.");
        if let Some(scores) = judged {
            say!(
                "\nPositions from torque, groups of trajectories left out of motions and friction (not of the model), all samples"
            );
            say_text!(table(&file.joints, &scores).to_text());
        }
        say!("\n{}", arguments.model.join(FORWARD).display());
    }
    Ok(())
}

/// Scores on trajectories that neither motions nor friction were learned from; none without folds.
fn judge(
    whole: &Loaded,
    data: &[(Recording, Motion)],
    arguments: &Forward,
    cancel: &AtomicBool,
) -> Result<Option<Row>, Failure> {
    let recordings: Vec<&Recording> = data.iter().map(|(r, _)| r).collect();
    let folds = Folds::of_visits(&recordings, arguments.folds);
    if arguments.folds == 0 {
        return Ok(None);
    }
    if folds.count < 2 {
        return Err(Failure::input(
            "all trajectories are of one group, repeats of each other: none can be left out to judge it",
            "Give recordings of different motions, or --folds 0 to leave the judging out.",
        ));
    }
    let fold = folds.of_trajectories(&recordings);
    let bar = progress::bar(arguments.running.quiet, "folds held back");
    let (mut measured, mut found, mut speed) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..folds.count {
        stop(cancel, "Nothing was written.")?;
        bar.set_position((100 * k / folds.count) as u64);
        let part = |inside: bool| -> Result<Vec<(Recording, Motion)>, Failure> {
            let mut parts = Vec::new();
            for ((recording, _), folds) in data.iter().zip(&fold) {
                let own: Vec<usize> = (0..folds.len())
                    .filter(|&t| (folds[t] == k) == inside)
                    .collect();
                if own.is_empty() {
                    continue;
                }
                let recording = recording.select(&own);
                let prepared = whole.file.preprocessing.prepare(&recording, None);
                let prepared = prepared.map_err(|e| Failure::input(e.to_string(), ""))?;
                parts.push((recording, prepared.at_samples));
            }
            Ok(parts)
        };
        let others = part(false)?;
        let others: Vec<(&Recording, &Motion)> = others.iter().map(|(r, m)| (r, m)).collect();
        let inversion = Inversion::learn(whole.model, &others)?;
        for (recording, motion) in part(true)? {
            found.push(inversion.positions(whole, &recording, cancel)?);
            measured.push(recording.q.clone());
            speed.push(motion.qd);
        }
    }
    bar.finish_and_clear();
    let stacked = |tables: &[Array2<f64>]| {
        let views: Vec<_> = tables.iter().map(|t| t.view()).collect();
        concatenate(Axis(0), &views).map_err(|e| Failure::other(e.to_string()))
    };
    let [all, _] = Row::both_scopes(
        PHYSICS_FORWARD,
        &stacked(&measured)?,
        &stacked(&found)?,
        &stacked(&speed)?,
    )
    .map_err(|e| Failure::other(e.to_string()))?;
    Ok(Some(all))
}

fn table(joints: &[String], row: &Row) -> Table {
    let columns = joints.iter().map(|j| Column::number(j.clone()));
    let mut table = Table::new(
        std::iter::once(Column::text(""))
            .chain(columns)
            .chain([Column::number("all")]),
    );
    let Scores {
        nrmse, mean_nrmse, ..
    } = &row.scores;
    let cells = nrmse
        .iter()
        .chain([mean_nrmse])
        .map(|v| Cell::optional(*v, 4));
    table.push(
        std::iter::once(Cell::text(row.name.as_str()))
            .chain(cells)
            .collect::<Vec<_>>(),
    );
    table
}
