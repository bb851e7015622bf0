//! Least attainable error of the moves' torque.

use super::arguments::Study;
use super::data::{Data, part};
use crate::oracle::{at_best_cutoff, true_torque};
use compensator::training::Fold;
use datasets::prepare::{PrepareOptions, prepare};
use model::failure::Failure;
use trials::protocols::{Protocol, cached};

/// RMSE by joint of the plant's own equations on the recorded motion, the gears' temperature unknown, mean over the folds' held-out
/// trajectories where the joint moves, N·m; at the cut-off of the motion at which they do best.
pub fn rmse(study: &Study, data: &Data, folds: &[Fold]) -> Result<Vec<f64>, Failure> {
    let failed = |e: trials::SimulateError| Failure::other(e.to_string());
    let set = cached(Protocol::Ur5, study.seed, &study.cache, &|_| {}).map_err(failed)?;
    let machine = Protocol::Ur5.machine().map_err(failed)?;
    let recording = part(&set, "moves")?;
    let run = &data.moves;
    let physics = data.physics_rmse(folds);
    let (errors, _) = at_best_cutoff(run.rate_hz, |cutoff_hz| {
        let options = PrepareOptions {
            cutoff_hz,
            ..PrepareOptions::default()
        };
        let prepared = prepare(recording, &options).map_err(|e| Failure::other(e.to_string()))?;
        let torque = true_torque(&machine, &prepared, Protocol::Ur5.motion_gain())?;
        let of = |joint: usize| {
            // What would have to be learned beside the physics, which is the torque without its residual.
            let learned = |row: usize| {
                torque[[row, joint]] - run.tau[[row, joint]] + f64::from(run.residual[[joint, row]])
            };
            let sum: f64 = folds
                .iter()
                .map(|f| run.rmse(joint, &f.test, learned))
                .sum();
            sum / folds.len() as f64
        };
        let errors: Vec<f64> = (0..data.joints.len()).map(of).collect();
        let total = std::iter::zip(&errors, &physics).map(|(e, p)| e / p).sum();
        Ok((total, errors))
    })?;
    Ok(errors)
}
